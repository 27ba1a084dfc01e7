"""Results on disk, found by the keys of the steps that made them.

Each result is one small file, beside files of the arrays' bytes. Several programs may use a folder
at once: every file is written under another name first, so that nobody ever sees half of one.
"""

from __future__ import annotations

import json
import os
import threading
import time
from collections import Counter
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.store import files
from nodegraph.store.blobs import Blobs
from nodegraph.store.entries import About, Entry, entry_of, packed_parts, read_entry
from nodegraph.store.packing import Packer, Unreadable, Unstorable

_HOUR = 3600.0
_README = """\
Results that nodegraph has stored. Any of it may be removed: it is computed again when it is needed.
`nodegraph cache` tells how much there is, `nodegraph cache prune` removes what was long unused.
"""


class DamagedEntry(NodegraphError):
    """A stored result is not what was written; it has been removed."""


class Store:
    """A folder of stored results. Every method may be called in any thread.

    Parameters
    ----------
    folder
        Made if it is not there.
    packer
        Takes values apart and puts them together.
    say
        Called with a line when something is damaged, or nothing can be kept any more.

    Attributes
    ----------
    writable : bool
        False once anything could not be written; nothing is tried any more then.
    unstorable : Counter of str
        Types whose values could not be kept, and how many results that has cost.
    """

    def __init__(self, folder: Path, packer: Packer, say: Callable[[str], None]) -> None:
        self.folder = folder.absolute()
        self.packer = packer
        self.writable = True
        self.unstorable: Counter[str] = Counter()
        self._say = say
        self._lock = threading.Lock()
        self._told: set[str] = set()
        self._root = str(self.folder / files.FORMAT)
        self._entries = f"{self._root}/entries"
        self._blobs = Blobs(f"{self._root}/blobs")
        self._make()

    def find(self, key: str) -> Entry | None:
        """Return what is stored under a key, without its values.

        A damaged entry is removed, told, and not found.
        """
        path = f"{self._entries}/{key[:2]}/{key[2:]}.json"
        try:
            content, changed = files.read(path)
            entry = read_entry(content, key)
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            self._tell(f"stored results cannot be read: {self.folder}: {error.strerror}")
            return None
        except (ValueError, LookupError, TypeError):
            entry = None
        if entry is None:
            self._remove_damaged(path, "a stored result is damaged")
        elif time.time() - changed > _HOUR:
            with suppress(OSError):
                os.utime(path)
        return entry

    def load(self, entry: Entry) -> tuple[Any, ...]:
        """Return the values of an entry; their arrays are read-only.

        Raises
        ------
        DamagedEntry
            If they are not what was written. The entry is removed.
        """
        try:
            parts = packed_parts(entry, self._blobs)
            return tuple(self.packer.unpack(head, buffers) for head, buffers in parts)
        except Unreadable as error:
            path = f"{self._entries}/{entry.key[:2]}/{entry.key[2:]}.json"
            text = f"the stored result of {entry.step} ({entry.node}) cannot be used: {error}"
            self._remove_damaged(path, text)
            raise DamagedEntry(f"{text}; entry {entry.key}") from error

    def save(self, key: str, about: About, values: tuple[Any, ...]) -> Entry | None:
        """Store a result and return its entry, or None when it cannot be kept.

        Parameters
        ----------
        key
        about
        values
            One per output; none for a result that was refused.
        """
        if not self.writable:
            return None
        try:
            packed = [self.packer.pack(value) for value in values]
            entry, content = entry_of(key, about, packed, self._blobs)
            files.write(f"{self._entries}/{key[:2]}", f"{key[2:]}.json", content)
        except Unstorable as error:
            with self._lock:
                self.unstorable[error.kind] += 1
            return None
        except OSError as error:
            self._give_up(error)
            return None
        return entry

    def remember(self, name: str, data: Mapping[str, Any]) -> None:
        """Keep a mapping of plain data, in place of what was kept under that name."""
        if self.writable:
            try:
                files.write(self._root, f"{name}.json", files.seal(json.dumps(data)))
            except OSError as error:
                self._give_up(error)

    def recall(self, name: str) -> dict[str, Any]:
        """Return what `remember` kept last; nothing if that is damaged."""
        try:
            text = files.unseal(files.read(f"{self._root}/{name}.json")[0])
            found = json.loads(text) if text is not None else {}
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) else {}

    def _make(self) -> None:
        if os.path.isdir(self._root):
            return
        try:
            files.write(self._root, "README", _README.encode())
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        with self._lock:
            if not self.writable:
                return
            self.writable = False
        self._say(f"results are no longer kept: {self.folder}: {error.strerror or error}")

    def _remove_damaged(self, path: str, text: str) -> None:
        with suppress(OSError):
            os.unlink(path)
        self._tell(f"{text}, and is computed again when it is needed: {path}")

    def _tell(self, text: str) -> None:
        with self._lock:
            if text in self._told:
                return
            self._told.add(text)
        self._say(text)
