"""How much is stored, and how the longest unused of it goes."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from pathlib import Path

from nodegraph.store import files
from nodegraph.store.store import Entry, read_entry

_HOUR = 3600.0
_ENTRY = ".json"


@dataclass(frozen=True, slots=True)
class Kept:
    """A stored result as it lies on disk.

    Attributes
    ----------
    entry : Entry
    path : str
    used : float
        When it was last written or found, to the hour, in seconds since 1970.
    length : int
        Bytes of the entry alone.
    """

    entry: Entry
    path: str
    used: float
    length: int


@dataclass(frozen=True, slots=True)
class Amount:
    """How many entries, how many files of arrays, and how many bytes all files have."""

    entries: int = 0
    blobs: int = 0
    size: int = 0

    def __add__(self, other: Amount) -> Amount:
        return Amount(
            self.entries + other.entries, self.blobs + other.blobs, self.size + other.size
        )


_NONE = Amount()


class Upkeep:
    """Looks after a store's folder; other programs may go on using it meanwhile."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self._root = str(self.folder / files.FORMAT)
        self._entries = f"{self._root}/entries"
        self._blobs = f"{self._root}/blobs"

    def entries(self) -> Iterator[Kept]:
        """Yield every entry that is whole."""
        for item in self._entry_files():
            entry = _kept(item.path)
            if entry is not None:
                yield entry

    def size(self) -> Amount:
        """Return how much there is."""
        amount = _NONE
        for entry in self._entry_files():
            amount += Amount(1, 0, _size(entry))
        for blob in self._blob_files():
            amount += Amount(0, 1, _size(blob))
        return amount

    def other_formats(self) -> list[str]:
        """Return names of folders of other versions of this program, which are left alone."""
        return sorted(
            path.name for path in self.folder.glob("format-*") if path.name != files.FORMAT
        )

    def prune(self, older_than: float | None = None, keep: int | None = None) -> Amount:
        """Remove entries, the longest unused first, then arrays that no entry needs.

        An array younger than an hour stays: another program may have written it just now for an
        entry that is still to come. What is dated in the future, by more than clocks differ,
        counts as unused for longest.

        Parameters
        ----------
        older_than
            Entries that were not used for so many seconds go.
        keep
            Entries go until all that is needed has at most so many bytes.
        """
        now = time.time()
        there = sorted(self.entries(), key=lambda entry: _past(entry.used, now))
        aged = [
            entry
            for entry in there
            if older_than is not None and now - _past(entry.used, now) > older_than
        ]
        left = there[len(aged) :]
        more = _too_many(left, self._blob_sizes(), keep) if keep is not None else []
        removed = sum(
            (_removed(entry.path, Amount(1, 0, entry.length)) for entry in aged + more), _NONE
        )
        needed = {name for entry in left[len(more) :] for name in entry.entry.blobs()}
        removed += self._without_damaged({entry.path for entry in there}, now)
        return removed + self._without_unneeded(needed, now) + self._without_unfinished(now)

    def clear(self) -> Amount:
        """Remove all that is stored."""
        removed = _NONE
        for entry in self._entry_files():
            removed += _removed(entry.path, Amount(1, 0, _size(entry)))
        for blob in self._blob_files():
            removed += _removed(blob.path, Amount(0, 1, _size(blob)))
        for item in files.files_in(self._root):
            if item.name.endswith(_ENTRY):  # what was remembered
                removed += _removed(item.path, Amount(0, 0, _size(item)))
        return removed + self._without_unfinished(float("inf"))

    def _entry_files(self) -> Iterator[os.DirEntry[str]]:
        return (item for item in self._all(self._entries) if item.name.endswith(_ENTRY))

    def _blob_files(self) -> Iterator[os.DirEntry[str]]:
        items = self._all(self._blobs)
        return (item for item in items if not item.name.endswith(files.UNFINISHED))

    def _blob_sizes(self) -> dict[str, int]:
        return {_name(blob): _size(blob) for blob in self._blob_files()}

    def _all(self, folder: str) -> Iterator[os.DirEntry[str]]:
        return (item for inner in files.folders_in(folder) for item in files.files_in(inner.path))

    def _without_damaged(self, whole: Set[str], now: float) -> Amount:
        removed = _NONE
        for entry in self._entry_files():
            if entry.path not in whole and now - _past(_changed(entry), now) > _HOUR:
                removed += _removed(entry.path, Amount(1, 0, _size(entry)))
        return removed

    def _without_unneeded(self, needed: Set[str], now: float) -> Amount:
        removed = _NONE
        for blob in self._blob_files():
            if _name(blob) not in needed and now - _past(_changed(blob), now) > _HOUR:
                removed += _removed(blob.path, Amount(0, 1, _size(blob)))
        return removed

    def _without_unfinished(self, now: float) -> Amount:
        """Remove what a program that was killed has left half written."""
        items = [*self._all(self._entries), *self._all(self._blobs), *files.files_in(self._root)]
        removed = _NONE
        for item in items:
            if item.name.endswith(files.UNFINISHED) and now - _past(_changed(item), now) > _HOUR:
                removed += _removed(item.path, Amount(0, 0, _size(item)))
        return removed


def _kept(path: str) -> Kept | None:
    folder, name = os.path.split(path)
    try:
        content, used = files.read(path)
    except OSError:
        return None
    entry = read_entry(content, os.path.basename(folder) + name.removesuffix(_ENTRY))
    return Kept(entry, path, used, len(content)) if entry is not None else None


def _past(changed: float, now: float) -> float:
    """Return a time in seconds since 1970, 0 for one in the future."""
    return changed if changed <= now + _HOUR else 0.0


def _too_many(there: Sequence[Kept], sizes: Mapping[str, int], keep: int) -> list[Kept]:
    """Return which entries go, the first ones first, for the rest to have so few bytes."""
    readers = Counter(name for entry in there for name in entry.entry.blobs())
    total = sum(entry.length for entry in there) + sum(sizes.get(name, 0) for name in readers)
    gone: list[Kept] = []
    for entry in there:
        if total <= keep:
            break
        gone.append(entry)
        readers.subtract(entry.entry.blobs().keys())
        freed = sum(sizes.get(name, 0) for name in entry.entry.blobs() if not readers[name])
        total -= entry.length + freed
    return gone


def _removed(path: str, amount: Amount) -> Amount:
    try:
        os.unlink(path)
    except FileNotFoundError:  # another program was quicker
        return _NONE
    return amount


def _name(blob: os.DirEntry[str]) -> str:
    return os.path.basename(os.path.dirname(blob.path)) + blob.name


def _size(item: os.DirEntry[str]) -> int:
    try:
        return item.stat(follow_symlinks=False).st_size
    except FileNotFoundError:
        return 0


def _changed(item: os.DirEntry[str]) -> float:
    try:
        # not what the folder said of it when it was listed: it may be in use again since
        return os.stat(item.path, follow_symlinks=False).st_mtime
    except FileNotFoundError:
        return 0.0
