"""The bytes of arrays, each in a file that is named by their SHA-256: equal ones lie there once."""

from __future__ import annotations

import os
from contextlib import suppress
from typing import TYPE_CHECKING

from nodegraph.store import files
from nodegraph.store.unstorable import Unreadable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Blobs:
    """A folder of such files."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def put(self, name: str, content: memoryview | bytes) -> None:
        """Keep bytes under their SHA-256.

        Raises
        ------
        OSError
            If that is not possible.
        """
        if self._there(name, len(content)):
            return
        files.write(f"{self.folder}/{name[:2]}", name[2:], content)

    def get(self, name: str, size: int) -> NDArray[np.uint8]:
        """Return the bytes in memory that nobody can write to.

        Raises
        ------
        Unreadable
            If they are not there, or not what they were; they are removed then.
        """
        path = self.path(name)
        try:
            found = files.read_checked(path, size, name)
        except OSError as error:
            raise Unreadable(f"{path}: {error.strerror}") from error
        if found is None:
            with suppress(OSError):
                os.unlink(path)
            raise Unreadable(f"{path} is not what was written")
        return found

    def path(self, name: str) -> str:
        """Return where bytes lie."""
        return f"{self.folder}/{name[:2]}/{name[2:]}"

    def _there(self, name: str, size: int) -> bool:
        path = self.path(name)
        try:
            if os.stat(path).st_size != size:
                return False
            # so that nobody takes it for one that no entry needs, before the entry is written
            os.utime(path)
        except FileNotFoundError:
            return False
        except PermissionError:
            return True
        return True
