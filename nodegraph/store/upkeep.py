"""Upkeep of the store: its size, and removal of what was unused for longest."""

from __future__ import annotations

import heapq
import os
import re
import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import NamedTuple

from nodegraph.errors import NodegraphError
from nodegraph.formatting import size_text
from nodegraph.store import files
from nodegraph.store.blobs import Blobs
from nodegraph.store.store import ENTRIES, FORMAT, Entry, other_formats, read_entry

_HOUR = 3600.0
_ENTRY = re.compile(r"([0-9a-f]{64})\.json")
_BLOB = re.compile("[0-9a-f]{64}")
_REMEMBERED = re.compile(r"(code|files|seconds|audit-[0-9a-f]+)\.json")
_SHARE = 5
"""The stored results take at most a fifth of the disk."""


@dataclass(frozen=True, slots=True)
class EntryOnDisk:
    """A stored result as it lies on disk.

    Attributes
    ----------
    entry : Entry
    used : float
        When it was last written or found, to the hour, in seconds since 1970.
    """

    entry: Entry
    used: float


@dataclass(frozen=True, slots=True)
class Amount:
    """The number of entries, of files of arrays, and of bytes in all files."""

    entries: int = 0
    blobs: int = 0
    size: int = 0


class _Listed(NamedTuple):
    """An entry as pruning sees it, without its values: there may be a million."""

    name: str
    used: float
    length: int
    blobs: tuple[str, ...]


_NO_FOLDER = (FileNotFoundError, NotADirectoryError)


class Upkeep:
    """Looks after a store's folder; other programs may keep using it meanwhile."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self._root = str(self.folder / FORMAT)

    def entries(self, most: int | None = None) -> Iterator[EntryOnDisk]:
        """Yield entries that are whole, the last used first.

        Parameters
        ----------
        most
            How many are read; all by default.
        """
        dated = ((status.st_mtime, name) for name, status in self._files(_ENTRY, ENTRIES))
        listed = sorted(dated, reverse=True) if most is None else heapq.nlargest(most, dated)
        for used, name in listed:
            if (entry := self._read(name)) is not None:
                yield EntryOnDisk(entry, used)

    def size(self) -> Amount:
        """Return the size of the store."""
        entries = [status.st_size for _, status in self._files(_ENTRY, ENTRIES)]
        return _amount(entries, list(self._blob_sizes().values()))

    def unneeded(self) -> Amount:
        """Return the arrays that no entry needs: of a run at work, or of one that was ended."""
        needed = {name for kept in self.entries() for name in kept.entry.blobs()}
        sizes = [size for name, size in self._blob_sizes().items() if name not in needed]
        return _amount([], sizes)

    def other_formats(self) -> list[str]:
        """Return names of folders of other versions of this program, which are left alone."""
        return other_formats(self.folder)

    def tidy(self) -> str:
        """Remove what is unused for longest beyond the bound on the size of the store.

        Returns
        -------
        str
            A line that says what was removed; empty if nothing was.
        """
        try:
            most = shutil.disk_usage(self._root).total // _SHARE
            if self.size().size <= most:
                return ""
            removed = self.prune(keep=most)
        except (OSError, NodegraphError):
            return ""
        if not removed.entries:
            return ""
        return (
            f"stored results had more than a fifth of the disk, {size_text(most)}: the "
            f"{removed.entries} that were unused for longest are removed from {self.folder}"
        )

    def prune(self, older_than: float | None = None, keep: int | None = None) -> Amount:
        """Remove entries, the longest unused first, then arrays that no entry needs.

        An array of a removed entry goes with it, unless it was written again since that entry. Any
        other array younger than an hour stays: another program may have written it just now for an
        entry that is still to come. What is dated in the future, by more than clocks differ,
        counts as unused for longest.

        Parameters
        ----------
        older_than
            Remove entries that were not used for this many seconds.
        keep
            Remove entries until the rest has at most this many bytes.

        Raises
        ------
        NodegraphError
            If the folder may not be changed.
        """
        now = time.time()
        there = sorted((_listed(kept, now) for kept in self.entries()), key=attrgetter("used"))
        gone = [each for each in there if older_than is not None and now - each.used > older_than]
        if keep is not None:
            gone += _too_many(there[len(gone) :], self._blob_sizes(), keep)
        left = there[len(gone) :]
        leaving, staying = {each.name for each in gone}, {each.name for each in left}
        needed = {name for each in left for name in each.blobs}

        # when the last of the leaving entries was written that needs an array
        written = {name: each.used for each in gone for name in each.blobs}

        def is_old(status: os.stat_result) -> bool:
            return now - _past(status.st_mtime, now) > _HOUR

        # what is neither leaving nor staying is damaged, or was written just now
        entries = self._remove(
            _ENTRY,
            ENTRIES,
            which=lambda name, status: name in leaving or (name not in staying and is_old(status)),
        )
        blobs = self._remove(
            _BLOB,
            Blobs.FOLDER,
            which=lambda name, status: (
                name not in needed and (is_old(status) or status.st_mtime <= written.get(name, 0.0))
            ),
        )
        return _amount(entries, blobs, self._remove_unfinished(is_old))

    def clear(self) -> Amount:
        """Remove all that is stored."""
        entries, blobs = self._remove(_ENTRY, ENTRIES), self._remove(_BLOB, Blobs.FOLDER)
        return _amount(
            entries, blobs, self._remove(_REMEMBERED) + self._remove_unfinished(lambda status: True)
        )

    def _remove_unfinished(self, is_old: Callable[[os.stat_result], bool]) -> list[int]:
        """Remove what a program that was killed has left half written; return the sizes."""
        return [
            size
            for inner in ((), (ENTRIES,), (Blobs.FOLDER,))
            for size in self._remove(
                files.UNFINISHED, *inner, which=lambda name, status: is_old(status)
            )
        ]

    def _remove(
        self,
        form: re.Pattern[str],
        *inner: str,
        which: Callable[[str, os.stat_result], bool] = lambda name, status: True,
    ) -> list[int]:
        """Remove files of a folder whose names have a form; return their sizes."""
        sizes: list[int] = []
        with suppress(*_NO_FOLDER), files.Folder(self._root, *inner) as folder:
            for name, status in folder.files(form):
                if which(name, status):
                    try:
                        folder.remove(name)
                    except FileNotFoundError:  # another program was quicker
                        continue
                    except OSError as error:
                        why = files.why_unchanged(str(self.folder), error)
                        raise NodegraphError(f"results cannot be removed: {why}") from error
                    sizes.append(status.st_size)
        return sizes

    def _blob_sizes(self) -> dict[str, int]:
        return {name: status.st_size for name, status in self._files(_BLOB, Blobs.FOLDER)}

    def _files(self, form: re.Pattern[str], *inner: str) -> Iterator[tuple[str, os.stat_result]]:
        """Yield name and status of the files of a folder whose names have a form."""
        try:
            with suppress(*_NO_FOLDER), files.Folder(self._root, *inner) as folder:
                yield from folder.files(form)
        except PermissionError as error:
            why = files.why_unchanged(str(self.folder), error)
            raise NodegraphError(f"results cannot be read: {why}") from error

    def _read(self, name: str) -> Entry | None:
        try:
            content, _ = files.read(f"{self._root}/{ENTRIES}/{name}")
        except OSError:
            return None
        return read_entry(content, name.removesuffix(".json"))


def _listed(kept: EntryOnDisk, now: float) -> _Listed:
    entry, used = kept.entry, _past(kept.used, now)
    return _Listed(f"{entry.key}.json", used, entry.length, tuple(entry.blobs()))


def _amount(entries: list[int], blobs: list[int], others: Iterable[int] = ()) -> Amount:
    return Amount(len(entries), len(blobs), sum(entries) + sum(blobs) + sum(others))


def _past(changed: float, now: float) -> float:
    """Return a time in seconds since 1970, 0 for one in the future."""
    return changed if changed <= now + _HOUR else 0.0


def _too_many(there: Sequence[_Listed], sizes: Mapping[str, int], keep: int) -> list[_Listed]:
    """Return the entries to remove, in order, so that the rest fits a number of bytes."""
    readers = Counter(name for each in there for name in each.blobs)
    total = sum(each.length for each in there) + sum(sizes.get(name, 0) for name in readers)
    gone: list[_Listed] = []
    for each in there:
        if total <= keep:
            break
        gone.append(each)
        readers.subtract(each.blobs)
        freed = sum(sizes.get(name, 0) for name in each.blobs if not readers[name])
        total -= each.length + freed
    return gone
