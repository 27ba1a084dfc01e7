"""Upkeep of the store: its size, packing, and removal of what was unused for longest."""

from __future__ import annotations

import heapq
import os
import shutil
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass
from itertools import islice
from operator import itemgetter
from pathlib import Path

from nodegraph.formatting import size_text
from nodegraph.store import files
from nodegraph.store.packs import LONGEST, Pack, Packed, Packs, Small
from nodegraph.store.store import Entry, read_entry

_HOUR = 3600.0
_ENTRY = ".json"
_FEW = 4096
"""Entries that may lie in files of their own."""
_MANY = 65536
"""Entries that are read to be packed at a time."""
_LARGEST = 2**22
"""Entries up to which packs are merged."""
_SHARE = 5
"""The stored results take at most a fifth of the disk."""


@dataclass(frozen=True, slots=True)
class Kept:
    """A stored result as it lies on disk.

    Attributes
    ----------
    entry : Entry
    used : float
        When it was last written or found, to the hour, in seconds since 1970.
    length : int
        Bytes of the entry alone.
    """

    entry: Entry
    used: float
    length: int


@dataclass(frozen=True, slots=True)
class _Placed:
    """An entry as pruning sees it, with its place: a path, or within a pack."""

    place: str | Packed
    used: float
    length: int
    blobs: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Amount:
    """The number of entries, of files of arrays, and of bytes in all files."""

    entries: int = 0
    blobs: int = 0
    size: int = 0

    def __add__(self, other: Amount) -> Amount:
        return Amount(
            self.entries + other.entries, self.blobs + other.blobs, self.size + other.size
        )


_NONE = Amount()


class Upkeep:
    """Looks after a store's folder; other programs may keep using it meanwhile."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self._root = str(self.folder / files.FORMAT)
        self._entries = f"{self._root}/entries"
        self._blobs = f"{self._root}/blobs"
        self._packs = Packs(f"{self._root}/packs")

    def entries(self, most: int | None = None) -> Iterator[Kept]:
        """Yield entries that are whole, the last used first.

        Parameters
        ----------
        most
            How many are read; all by default.
        """
        places: list[tuple[float, str | Packed]] = [
            (_changed(item), item.path) for item in self._entry_files()
        ]
        places += [(packed.used, packed) for packed in self._packed()]
        count = len(places) if most is None else most
        for _, place in heapq.nlargest(count, places, key=itemgetter(0)):
            kept = _kept(place) if isinstance(place, str) else _kept_in_pack(place)
            if kept is not None:
                yield kept

    def size(self) -> Amount:
        """Return the size of the store."""
        amount = _NONE
        for entry in self._entry_files():
            amount += Amount(1, 0, files.size_of(entry))
        for pack in self._packs.all():
            amount += Amount(sum(1 for _ in pack), 0, pack.size)
        for blob in self._blob_files():
            amount += Amount(0, 1, files.size_of(blob))
        return amount

    def other_formats(self) -> list[str]:
        """Return names of folders of other versions of this program, which are left alone."""
        return sorted(
            path.name for path in self.folder.glob("format-*") if path.name != files.FORMAT
        )

    def tidy(self) -> str:
        """Pack what lies in too many files; remove what is unused for longest beyond the bound.

        Returns
        -------
        str
            A line that says what was removed; empty if nothing was.
        """
        with suppress(OSError):  # a disk that is full, or not to be written to
            self._pack()
        try:
            most = shutil.disk_usage(self._root).total // _SHARE
            removed = self.prune(keep=most) if self.size().size > most else _NONE
        except OSError:
            return ""
        if removed == _NONE:
            return ""
        return (
            f"stored results had more than a fifth of the disk, {size_text(most)}: the "
            f"{removed.entries} that were unused for longest are removed from {self.folder}"
        )

    def prune(self, older_than: float | None = None, keep: int | None = None) -> Amount:
        """Remove entries, the longest unused first, then arrays that no entry needs.

        An array younger than an hour stays: another program may have written it just now for an
        entry that is still to come. What is dated in the future, by more than clocks differ,
        counts as unused for longest.

        Parameters
        ----------
        older_than
            Remove entries that were not used for this many seconds.
        keep
            Remove entries until the rest has at most this many bytes.
        """
        with self._alone():
            return self._pruned(older_than, keep)

    def _pruned(self, older_than: float | None, keep: int | None) -> Amount:
        now = time.time()
        there = sorted(self._placed(), key=lambda entry: _past(entry.used, now))
        aged = [
            entry
            for entry in there
            if older_than is not None and now - _past(entry.used, now) > older_than
        ]
        left = there[len(aged) :]
        more = _too_many(left, self._blob_sizes(), keep) if keep is not None else []
        gone = aged + more
        removed = sum(map(_without, gone), _NONE)
        needed = {name for entry in left[len(more) :] for name in entry.blobs}
        whole = {entry.place for entry in there if isinstance(entry.place, str)}
        removed += self._without_damaged(whole, now)
        removed += self._without_unneeded(needed, now) + self._without_unfinished(now)
        with suppress(OSError):  # a disk that is full: what is removed goes with the next packing
            self._pack_all({entry.place.pack for entry in gone if isinstance(entry.place, Packed)})
        return removed

    def clear(self) -> Amount:
        """Remove all that is stored."""
        with self._alone():
            return self._cleared()

    def _cleared(self) -> Amount:
        removed = _NONE
        for entry in self._entry_files():
            removed += _removed(entry.path, Amount(1, 0, files.size_of(entry)))
        counts = {pack.path: sum(1 for _ in pack) for pack in self._packs.all()}
        for item in files.files_in(self._packs.folder):
            removed += _removed(item.path, Amount(counts.get(item.path, 0), 0, files.size_of(item)))
        for blob in self._blob_files():
            removed += _removed(blob.path, Amount(0, 1, files.size_of(blob)))
        for item in files.files_in(self._root):
            if item.name.endswith(_ENTRY):  # what was remembered
                removed += _removed(item.path, Amount(0, 0, files.size_of(item)))
        return removed + self._without_unfinished(float("inf"))

    def _alone(self) -> AbstractContextManager[object]:
        """Wait for a program that packs, which else would keep what is removed meanwhile."""
        is_there = os.path.isdir(self._root)
        return self._packs.alone(wait=True) if is_there else nullcontext()

    def _pack(self) -> None:
        """Put entries in files of their own together, once there are many, unless another does."""
        if len(list(islice(self._small_files(), _FEW))) == _FEW:
            with self._packs.alone() as alone:
                if alone:
                    self._pack_all(set())

    def _pack_all(self, old: Set[Pack]) -> None:
        """Put entries together, and write packs from which entries were removed again."""
        left = self._small_files()
        while (paths := list(islice(left, _MANY))) or old:
            if old or len(paths) >= _FEW:
                self._pack_together(paths, old)
            old = set()

    def _pack_together(self, paths: Sequence[str], old: Set[Pack]) -> None:
        loose = {path: small for path in paths if (small := _small(path)) is not None}
        packs = self._packs.all()
        merged, count = set(old), len(loose)
        # packs of like sizes, so that there are few, and each entry is written few times
        for pack in sorted(packs, key=len):
            if len(pack) <= count <= _LARGEST - len(pack):
                merged.add(pack)
                count += len(pack)
        there = {
            packed.key: Small(packed.key, packed.used, packed.record.blobs, packed)
            for pack in merged
            for packed in pack
            if files.unseal(packed.content()) is not None  # what is damaged ends here
        }
        newest = {small.key: small for small in loose.values()}
        self._packs.add({**there, **newest}.values())
        for key in newest:
            for pack in packs:
                if (former := pack.find(key)) is not None:
                    former.remove()
        for path in (*loose, *(pack.path for pack in merged)):
            with suppress(FileNotFoundError):
                os.unlink(path)

    def _placed(self) -> Iterator[_Placed]:
        for item in self._entry_files():
            kept = _kept(item.path)
            if kept is not None:
                blobs = tuple(kept.entry.blobs())
                yield _Placed(item.path, kept.used, kept.length, blobs)
        for packed in self._packed():
            has_blobs = packed.record.blobs > 0
            entry = read_entry(packed.content(), packed.key.hex()) if has_blobs else None
            if has_blobs and entry is None:  # damaged
                packed.remove()
                continue
            blobs = tuple(entry.blobs()) if entry is not None else ()
            yield _Placed(packed, packed.used, packed.record.length, blobs)

    def _packed(self) -> Iterator[Packed]:
        return (packed for pack in self._packs.all() for packed in pack)

    def _entry_files(self) -> Iterator[os.DirEntry[str]]:
        return (item for item in self._all(self._entries) if item.name.endswith(_ENTRY))

    def _small_files(self) -> Iterator[str]:
        """Yield the paths of entries that share a pack with others."""
        return (item.path for item in self._entry_files() if files.size_of(item) <= LONGEST)

    def _blob_files(self) -> Iterator[os.DirEntry[str]]:
        items = self._all(self._blobs)
        return (item for item in items if not item.name.endswith(files.UNFINISHED))

    def _blob_sizes(self) -> dict[str, int]:
        return {_name(blob): files.size_of(blob) for blob in self._blob_files()}

    def _all(self, folder: str) -> Iterator[os.DirEntry[str]]:
        return (item for inner in files.folders_in(folder) for item in files.files_in(inner.path))

    def _without_damaged(self, whole: Set[str], now: float) -> Amount:
        removed = _NONE
        for entry in self._entry_files():
            if entry.path not in whole and now - _past(_changed(entry), now) > _HOUR:
                removed += _removed(entry.path, Amount(1, 0, files.size_of(entry)))
        return removed

    def _without_unneeded(self, needed: Set[str], now: float) -> Amount:
        removed = _NONE
        for blob in self._blob_files():
            if _name(blob) not in needed and now - _past(_changed(blob), now) > _HOUR:
                removed += _removed(blob.path, Amount(0, 1, files.size_of(blob)))
        return removed

    def _without_unfinished(self, now: float) -> Amount:
        """Remove what a program that was killed has left half written."""
        items = [*self._all(self._entries), *self._all(self._blobs)]
        items += [*files.files_in(self._packs.folder), *files.files_in(self._root)]
        removed = _NONE
        for item in items:
            if item.name.endswith(files.UNFINISHED) and now - _past(_changed(item), now) > _HOUR:
                removed += _removed(item.path, Amount(0, 0, files.size_of(item)))
        return removed


def _kept(path: str) -> Kept | None:
    try:
        content, used = files.read(path)
    except OSError:
        return None
    entry = read_entry(content, _key(path))
    return Kept(entry, used, len(content)) if entry is not None else None


def _kept_in_pack(packed: Packed) -> Kept | None:
    entry = read_entry(packed.content(), packed.key.hex())
    return Kept(entry, packed.used, packed.record.length) if entry is not None else None


def _small(path: str) -> Small | None:
    try:
        content, used = files.read(path)
    except OSError:
        return None
    entry = read_entry(content, _key(path))
    if entry is None:
        return None
    return Small(bytes.fromhex(entry.key), used, len(entry.blobs()), content)


def _key(path: str) -> str:
    folder, name = os.path.split(path)
    return os.path.basename(folder) + name.removesuffix(_ENTRY)


def _past(changed: float, now: float) -> float:
    """Return a time in seconds since 1970, 0 for one in the future."""
    return changed if changed <= now + _HOUR else 0.0


def _too_many(there: Sequence[_Placed], sizes: Mapping[str, int], keep: int) -> list[_Placed]:
    """Return the entries to remove, in order, so that the rest fits a number of bytes."""
    readers = Counter(name for entry in there for name in entry.blobs)
    total = sum(entry.length for entry in there) + sum(sizes.get(name, 0) for name in readers)
    gone: list[_Placed] = []
    for entry in there:
        if total <= keep:
            break
        gone.append(entry)
        readers.subtract(entry.blobs)
        freed = sum(sizes.get(name, 0) for name in entry.blobs if not readers[name])
        total -= entry.length + freed
    return gone


def _without(entry: _Placed) -> Amount:
    amount = Amount(1, 0, entry.length)
    if isinstance(entry.place, str):
        return _removed(entry.place, amount)
    entry.place.remove()
    return amount


def _removed(path: str, amount: Amount) -> Amount:
    try:
        os.unlink(path)
    except FileNotFoundError:  # another program was quicker
        return _NONE
    return amount


def _name(blob: os.DirEntry[str]) -> str:
    return os.path.basename(os.path.dirname(blob.path)) + blob.name


def _changed(item: os.DirEntry[str]) -> float:
    try:
        # not what the folder said of it when it was listed: it may be in use again since
        return os.stat(item.path, follow_symlinks=False).st_mtime
    except FileNotFoundError:
        return 0.0
