"""Small entries together: a pack holds thousands in one file that is written once.

A disk gives every file a block or more, so that a small entry takes several times its length, and
a folder of a million files takes minutes to go through. New entries are files of their own, which
needs no lock; `Packs.add` puts them together later. A pack is a header, the sorted keys, a record
for each key, and the entries. All that changes in it afterwards is the hour in a record. So readers
need no lock either, on any disk: what is torn or forged is caught by the checksum of the entry.
"""

from __future__ import annotations

import os
import re
import secrets
import struct
import time
import weakref
from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import NamedTuple

from nodegraph.store import files

_NAME = re.compile(r"[0-9a-f]{16}\.pack")
FILES = re.compile(rf"{_NAME.pattern}|lock")
"""Names of packs, and of the file that is locked while they are written."""
_HEADER = struct.Struct("<16sQ")
_MAGIC = b"nodegraph pack 1"
_KEY = 32
_RECORD = struct.Struct("<QIII")
_HOUR_AT = 12
"""Offset of the hour in a record."""
_HOUR = 3600.0
_CAN_PACK = hasattr(os, "pread")
"""Whether this system reads at a place of a file that others read as well; Windows does not."""
_MOST_ENTRIES = 2**25
"""Of all packs that are open; what claims more is left alone."""
LONGEST = 16384
"""Bytes of an entry in a pack; a longer one wastes little of the disk in a file of its own."""
_MOST_PACKS = 256
"""That are open at a time. Few more than the logarithm of the number of entries are written."""
_BLOCK = 128
"""Keys or records that are read at a time: memory stays the same, however many a pack claims."""
_LATELY = 2.0
"""Seconds in which a folder may change again without another time of change."""


class Record(NamedTuple):
    """The place of an entry in a pack, and the data known without reading it.

    Attributes
    ----------
    offset, length : int
        In bytes.
    hour : int
        When it was last used, since 1970; 0 once it is removed.
    blobs : int
        How many blobs it needs.
    """

    offset: int
    length: int
    hour: int
    blobs: int


@dataclass(frozen=True, slots=True)
class Small:
    """An entry to be packed: its content, or where it is already."""

    key: bytes
    used: float
    blobs: int
    content: bytes | Packed


class Pack:
    """An open pack.

    Parameters
    ----------
    folder
    name

    Raises
    ------
    OSError
        If it cannot be opened.
    ValueError
        If it is not a pack.
    """

    def __init__(self, folder: files.Folder, name: str) -> None:
        self.name = name
        self.path = path = f"{folder.path}/{name}"
        try:
            self._file = folder.open(name, os.O_RDWR)
        except OSError:  # nobody may write there
            self._file = folder.open(name, os.O_RDONLY)
        # not at the end of a block: a store may go on reading what another has replaced
        weakref.finalize(self, os.close, self._file)
        self.size = os.fstat(self._file).st_size
        header = os.pread(self._file, _HEADER.size, 0)
        magic, count = _HEADER.unpack(header) if len(header) == _HEADER.size else (b"", 0)
        self._count: int = count
        if magic != _MAGIC or count > _MOST_ENTRIES or _start(count) > self.size:
            raise ValueError(f"{path} is not a pack")
        self._records = _HEADER.size + self._count * _KEY
        self._first_keys: dict[int, bytes] = {}

    def __len__(self) -> int:
        return self._count

    def find(self, key: bytes) -> Packed | None:
        """Return an entry, unless it is not there or was removed."""
        block = bisect_right(range(0, self._count, _BLOCK), key, key=self._first_key) - 1
        if block < 0:
            return None
        keys = self._keys(block * _BLOCK)
        at = bisect_left(range(0, len(keys), _KEY), key, key=lambda at: keys[at : at + _KEY])
        if keys[at * _KEY : at * _KEY + _KEY] != key:
            return None
        index = block * _BLOCK + at
        data = os.pread(self._file, _RECORD.size, self._records + index * _RECORD.size)
        if len(data) < _RECORD.size:
            return None
        record = Record(*_RECORD.unpack(data))
        return Packed(self, index, key, record) if record.hour else None

    def __iter__(self) -> Iterator[Packed]:
        """Yield every entry that was not removed, as far as the file is as long as they say.

        So what is written of a forged pack is never longer than it is.
        """
        left = self.size
        for start in range(0, self._count, _BLOCK):
            for index, (key, record) in enumerate(self._records_from(start), start):
                is_whole = record.offset + record.length <= self.size
                if record.hour and is_whole and record.length <= min(left, LONGEST):
                    left -= record.length
                    yield Packed(self, index, key, record)

    def read(self, record: Record) -> bytes:
        """Return the content of an entry; less of it where the pack ends before."""
        if record.length > LONGEST or record.offset + record.length > self.size:
            return b""
        return os.pread(self._file, record.length, record.offset)

    def note(self, index: int, hour: int) -> None:
        """Note when an entry was used last."""
        at = self._records + index * _RECORD.size + _HOUR_AT
        os.pwrite(self._file, struct.pack("<I", hour), at)

    def _first_key(self, start: int) -> bytes:
        """Return the first key of a block; the same few are compared in every search."""
        key = self._first_keys.get(start)
        if key is None:
            key = os.pread(self._file, _KEY, _HEADER.size + start * _KEY)
            self._first_keys[start] = key
        return key

    def _keys(self, start: int) -> bytes:
        """Return the keys of a block; fewer where another program has cut the file."""
        count = min(_BLOCK, self._count - start)
        return os.pread(self._file, count * _KEY, _HEADER.size + start * _KEY)

    def _records_from(self, start: int) -> Iterator[tuple[bytes, Record]]:
        """Yield keys and records of a block."""
        keys = self._keys(start)
        at = self._records + start * _RECORD.size
        records = os.pread(self._file, len(keys) // _KEY * _RECORD.size, at)
        whole = len(records) // _RECORD.size * _RECORD.size  # another program may have cut it
        for index, parts in enumerate(_RECORD.iter_unpack(records[:whole])):
            yield keys[index * _KEY : index * _KEY + _KEY], Record(*parts)


@dataclass(frozen=True, slots=True)
class Packed:
    """An entry in a pack."""

    pack: Pack
    index: int
    key: bytes
    record: Record

    @property
    def used(self) -> float:
        """When it was last used, to the hour, in seconds since 1970."""
        return self.record.hour * _HOUR

    def content(self) -> bytes:
        """Return its content."""
        return self.pack.read(self.record)

    def touch(self) -> None:
        """Note that it is used now."""
        with suppress(OSError):
            self.pack.note(self.index, int(time.time() / _HOUR))

    def remove(self) -> None:
        """Remove it; its bytes go when the pack is rewritten."""
        with suppress(OSError):
            self.pack.note(self.index, 0)


class Packs:
    """The packs of a store, as other programs add and replace them.

    Parameters
    ----------
    root
        The folder of the store's format.
    """

    def __init__(self, root: str) -> None:
        self._root = root
        self._open: dict[str, Pack] = {}
        self._changed = -1

    def find(self, key: str) -> Packed | None:
        """Return an entry, or None."""
        wanted = bytes.fromhex(key)
        for pack in self.all():
            if (packed := pack.find(wanted)) is not None:
                return packed
        return None

    def all(self) -> list[Pack]:
        """Return the packs that are there now."""
        try:
            changed = os.stat(f"{self._root}/{files.PACKS}").st_mtime_ns
        except FileNotFoundError:
            changed = 0
        if changed != self._changed or time.time() - changed / 1e9 < _LATELY:
            self._open = self._opened()
            self._changed = changed  # last: another thread may look meanwhile
        return list(self._open.values())

    def _opened(self) -> dict[str, Pack]:
        opened: dict[str, Pack] = {}
        left = _MOST_ENTRIES
        try:
            with self.folder() as folder:
                # the smallest first: what claims the most is left alone
                for name in sorted(folder.names(_NAME) if _CAN_PACK else (), key=folder.size):
                    pack = self._open.get(name) or _opened(folder, name)
                    if pack is not None and len(pack) <= left and len(opened) < _MOST_PACKS:
                        opened[name] = pack
                        left -= len(pack)
        except (FileNotFoundError, NotADirectoryError):
            pass
        return opened

    def folder(self) -> files.Folder:
        """Open their folder.

        Raises
        ------
        OSError
            If it is not there.
        """
        return files.Folder(self._root, files.PACKS)

    def add(self, entries: Iterable[Small]) -> None:
        """Write entries as one pack.

        Raises
        ------
        OSError
            If it cannot be written; nothing of it is left then.
        """
        listed = sorted(entries, key=lambda entry: entry.key)
        if listed:
            name = f"{secrets.token_hex(8)}.pack"
            with self.folder() as folder:
                # what was packed is removed next
                folder.write(name, _parts(listed), durable=True)

    @contextmanager
    def alone(self, *, wait: bool = False) -> Iterator[bool]:
        """Keep other programs from packing meanwhile; give whether this one may pack.

        Parameters
        ----------
        wait
            Whether to wait for a program that packs already.
        """
        with files.Folder(self._root, files.PACKS, make=True) as folder:
            opened = folder.open("lock", os.O_WRONLY | os.O_CREAT)
        with open(opened, "ab") as lock:
            yield files.locked(lock, wait=wait) and _CAN_PACK


def _opened(folder: files.Folder, name: str) -> Pack | None:
    try:
        return Pack(folder, name)
    except (OSError, ValueError):
        return None


def _start(count: int) -> int:
    """Return where the first entry of a pack begins."""
    return _HEADER.size + count * (_KEY + _RECORD.size)


def _parts(entries: list[Small]) -> Iterator[bytes]:
    yield _HEADER.pack(_MAGIC, len(entries))
    yield b"".join(entry.key for entry in entries)
    offset = _start(len(entries))
    records: list[bytes] = []
    for entry in entries:
        content = entry.content
        length = content.record.length if isinstance(content, Packed) else len(content)
        hour = max(1, int(entry.used / _HOUR))
        records.append(_RECORD.pack(offset, length, hour, entry.blobs))
        offset += length
    yield b"".join(records)
    for entry in entries:
        content = entry.content
        if isinstance(content, Packed):
            # one that was cut off stays one that is damaged, and those after it stay whole
            yield content.content().ljust(content.record.length, b"\0")
        else:
            yield content
