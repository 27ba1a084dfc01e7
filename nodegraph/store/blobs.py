"""Files of bytes that are named after their SHA-256, so that equal arrays are stored once."""

from __future__ import annotations

import hashlib
import os
import stat
from typing import TYPE_CHECKING

from nodegraph.store import files
from nodegraph.store.errors import Unreadable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_PIECE = 2**20
"""Bytes that are read before they are summed up."""


class Blobs:
    """The files of arrays of a store.

    Parameters
    ----------
    root
        The folder of the store's format.
    """

    FOLDER = "blobs"

    def __init__(self, root: str) -> None:
        self._root = root

    def put(self, name: str, content: memoryview | bytes) -> None:
        """Store bytes under their SHA-256.

        Raises
        ------
        OSError
            If that is not possible.
        """
        with files.Folder(self._root, self.FOLDER, make=True) as folder:
            if not _is_there(folder, name, len(content)):
                folder.write(name, content)

    def get(self, name: str, size: int) -> NDArray[np.uint8]:
        """Return the bytes in memory that nobody can write to.

        Raises
        ------
        Unreadable
            If they are not there or not what was written. A damaged file is removed; an entry that
            claims another size than was written removes nothing.
        """
        path = f"{self._root}/{self.FOLDER}/{name}"
        try:
            memory = _read_checked(path, name, size)
            if memory is None and not _is_whole(path, name):
                with files.Folder(self._root, self.FOLDER) as folder:
                    folder.remove(name)
        except OSError as error:
            raise Unreadable(f"{path}: {error.strerror}") from error
        if memory is None:
            raise Unreadable(f"{path} is not what was written")
        return memory


def _read_checked(path: str, name: str, size: int) -> NDArray[np.uint8] | None:
    """Return the content of a file; None if its size or its SHA-256 is another."""
    import numpy as np

    summed = hashlib.sha256()
    with open(os.open(path, files.READ), "rb", buffering=0) as opened:
        # before memory is taken for what an entry claims; a pipe or a device has no size
        if os.fstat(opened.fileno()).st_size != size:
            return None
        memory = np.empty(size, np.uint8)
        pieces = memory.data
        filled = 0
        while got := opened.readinto(pieces[filled : filled + _PIECE]):
            # what has just been read is still close to the processor
            summed.update(pieces[filled : filled + got])
            filled += got
    memory.flags.writeable = False
    return memory if filled == size and summed.hexdigest() == name else None


def _is_whole(path: str, name: str) -> bool:
    """Return whether the SHA-256 of a file's content is its name; a device or a pipe is not."""
    with open(os.open(path, files.READ), "rb") as opened:
        if not stat.S_ISREG(os.fstat(opened.fileno()).st_mode):
            return False
        return hashlib.file_digest(opened, "sha256").hexdigest() == name


def _is_there(folder: files.Folder, name: str, size: int) -> bool:
    try:
        if folder.status(name).st_size != size:
            return False
        # so that nobody takes it for one that no entry needs, before the entry is written
        folder.touch(name)
    except FileNotFoundError:
        return False
    except PermissionError:
        pass
    return True
