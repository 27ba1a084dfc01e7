"""Upkeep of the store: its size, packing, and removal of what was unused for longest."""

from __future__ import annotations

import heapq
import os
import re
import shutil
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass
from itertools import chain, islice
from operator import itemgetter
from pathlib import Path

from nodegraph.formatting import size_text
from nodegraph.store import files
from nodegraph.store.packs import FILES, LONGEST, Pack, Packed, Packs, Small
from nodegraph.store.store import Entry, read_entry

_HOUR = 3600.0
_REMEMBERED = re.compile(r"(code|files|seconds|audit-[0-9a-f]+)\.json")
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
    """An entry as pruning sees it, with its place: the key of its own file, or within a pack."""

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
_File = tuple[files.Folder, str]


class Upkeep:
    """Looks after a store's folder; other programs may keep using it meanwhile."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self._root = str(self.folder / files.FORMAT)
        self._packs = Packs(self._root)

    def entries(self, most: int | None = None) -> Iterator[Kept]:
        """Yield entries that are whole, the last used first.

        Parameters
        ----------
        most
            How many are read; all by default.
        """
        places: list[tuple[float, str | Packed]] = [
            (_changed(folder, name), _key(folder, name)) for folder, name in self._entries()
        ]
        places += [(packed.used, packed) for packed in self._packed()]
        count = len(places) if most is None else most
        for _, place in heapq.nlargest(count, places, key=itemgetter(0)):
            kept = self._kept(place) if isinstance(place, str) else _kept_in_pack(place)
            if kept is not None:
                yield kept

    def size(self) -> Amount:
        """Return the size of the store."""
        amount = _NONE
        for folder, name in self._entries():
            amount += Amount(1, 0, folder.size(name))
        for pack in self._packs.all():
            amount += Amount(sum(1 for _ in pack), 0, pack.size)
        for folder, name in self._blobs():
            amount += Amount(0, 1, folder.size(name))
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
        removed = sum(map(self._without, gone), _NONE)
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
        for folder, name in self._entries():
            removed += _removed(folder, name, Amount(1, 0, folder.size(name)))
        counts = {pack.name: sum(1 for _ in pack) for pack in self._packs.all()}
        for folder, name in self._files(FILES, files.PACKS):
            removed += _removed(folder, name, Amount(counts.get(name, 0), 0, folder.size(name)))
        for folder, name in self._blobs():
            removed += _removed(folder, name, Amount(0, 1, folder.size(name)))
        for folder, name in self._files(_REMEMBERED):
            removed += _removed(folder, name, Amount(0, 0, folder.size(name)))
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
        while (keys := list(islice(left, _MANY))) or old:
            if old or len(keys) >= _FEW:
                self._pack_together(keys, old)
            old = set()

    def _pack_together(self, keys: Sequence[str], old: Set[Pack]) -> None:
        loose = {key: small for key in keys if (small := self._small(key)) is not None}
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
        for key, small in loose.items():
            for pack in packs:
                if (former := pack.find(small.key)) is not None:
                    former.remove()
            self._without_entry(key, _NONE)
        with self._packs.folder() as folder:
            for pack in merged:
                _removed(folder, pack.name, _NONE)

    def _placed(self) -> Iterator[_Placed]:
        for folder, name in self._entries():
            kept = self._kept(_key(folder, name))
            if kept is not None:
                blobs = tuple(kept.entry.blobs())
                yield _Placed(kept.entry.key, kept.used, kept.length, blobs)
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

    def _entries(self) -> Iterator[_File]:
        return self._all(files.ENTRIES, files.ENTRY)

    def _small_files(self) -> Iterator[str]:
        """Yield the keys of entries that share a pack with others."""
        for folder, name in self._entries():
            if folder.size(name) <= LONGEST:
                yield _key(folder, name)

    def _blobs(self) -> Iterator[_File]:
        return self._all(files.BLOBS, files.BLOB)

    def _blob_sizes(self) -> dict[str, int]:
        return {_key(folder, name): folder.size(name) for folder, name in self._blobs()}

    def _all(self, part: str, form: re.Pattern[str]) -> Iterator[_File]:
        """Yield the files, with names of a form, of a part of the store."""
        try:
            with files.Folder(self._root, part) as opened:
                names = opened.folders()
        except (FileNotFoundError, NotADirectoryError):
            return
        for name in names:
            yield from self._files(form, part, name)

    def _files(self, form: re.Pattern[str], *inner: str) -> Iterator[_File]:
        """Yield the files, with names of a form, of a folder, which is open meanwhile."""
        try:
            with files.Folder(self._root, *inner) as folder:
                for name in folder.names(form):
                    yield folder, name
        except (FileNotFoundError, NotADirectoryError):
            return

    def _without(self, entry: _Placed) -> Amount:
        amount = Amount(1, 0, entry.length)
        if isinstance(entry.place, str):
            return self._without_entry(entry.place, amount)
        entry.place.remove()
        return amount

    def _without_entry(self, key: str, amount: Amount) -> Amount:
        with (
            suppress(FileNotFoundError),
            files.Folder(self._root, files.ENTRIES, key[:2]) as folder,
        ):
            return _removed(folder, f"{key[2:]}.json", amount)
        return _NONE

    def _without_damaged(self, whole: Set[str], now: float) -> Amount:
        removed = _NONE
        for folder, name in self._entries():
            if _key(folder, name) not in whole and _is_old(folder, name, now):
                removed += _removed(folder, name, Amount(1, 0, folder.size(name)))
        return removed

    def _without_unneeded(self, needed: Set[str], now: float) -> Amount:
        removed = _NONE
        for folder, name in self._blobs():
            if _key(folder, name) not in needed and _is_old(folder, name, now):
                removed += _removed(folder, name, Amount(0, 1, folder.size(name)))
        return removed

    def _without_unfinished(self, now: float) -> Amount:
        """Remove what a program that was killed has left half written."""
        form = files.UNFINISHED
        places = (self._all(files.ENTRIES, form), self._all(files.BLOBS, form))
        removed = _NONE
        for folder, name in chain(*places, self._files(form, files.PACKS), self._files(form)):
            if _is_old(folder, name, now):
                removed += _removed(folder, name, Amount(0, 0, folder.size(name)))
        return removed

    def _kept(self, key: str) -> Kept | None:
        content, used = self._content(key)
        entry = read_entry(content, key)
        return Kept(entry, used, len(content)) if entry is not None else None

    def _small(self, key: str) -> Small | None:
        content, used = self._content(key)
        entry = read_entry(content, key)
        if entry is None:
            return None
        return Small(bytes.fromhex(key), used, len(entry.blobs()), content)

    def _content(self, key: str) -> tuple[bytes, float]:
        """Return the content of an entry's file, empty if it cannot be read, and its date."""
        try:
            return files.read(f"{self._root}/{files.ENTRIES}/{key[:2]}/{key[2:]}.json")
        except OSError:
            return b"", 0.0


def _kept_in_pack(packed: Packed) -> Kept | None:
    entry = read_entry(packed.content(), packed.key.hex())
    return Kept(entry, packed.used, packed.record.length) if entry is not None else None


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


def _removed(folder: files.Folder, name: str, amount: Amount) -> Amount:
    try:
        folder.remove(name)
    except FileNotFoundError:  # another program was quicker
        return _NONE
    return amount


def _key(folder: files.Folder, name: str) -> str:
    """Return the key of an entry's file, or the digest of a blob's."""
    return f"{os.path.basename(folder.path)}{name.partition('.')[0]}"


def _is_old(folder: files.Folder, name: str, now: float) -> bool:
    return now - _past(_changed(folder, name), now) > _HOUR


def _changed(folder: files.Folder, name: str) -> float:
    try:
        return folder.status(name).st_mtime
    except FileNotFoundError:
        return 0.0
