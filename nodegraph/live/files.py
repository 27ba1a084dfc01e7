"""Files as sources and sinks: ``replay:take.c3d@240`` and ``file:filled.npz``."""

from __future__ import annotations

import os
import re
import struct
import time
import warnings
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cached_property
from itertools import chain, repeat
from pathlib import Path
from threading import TIMEOUT_MAX, Event

from nodegraph.equality import difference
from nodegraph.errors import NodegraphError, listed, message_of
from nodegraph.live.addresses import source_of
from nodegraph.live.forms import header_of, streamable_of
from nodegraph.live.packet_file import MAGIC, PacketFileReader
from nodegraph.node.decorator import Node
from nodegraph.plugin.formats import current_registry
from nodegraph.plugin.streaming import JUMP, Frame, Source
from nodegraph.runs.export import exporters_of

_RATE = re.compile(r"(.+)@(\d+(?:\.\d*)?)")
_INDEX = struct.Struct("<q")


def replay(address: str) -> Source:
    """Return a source that replays a file: one that a reader reads, or recorded packets.

    Parameters
    ----------
    address
        ``FILE`` in the pace in which it was recorded, ``FILE@240`` at 240 frames per second, or
        ``FILE@0`` as fast as frames are taken. The pace changes no result.

    Raises
    ------
    NodegraphError
        If there is no such file, or its recorded packets cannot be read.
    """
    match = _RATE.fullmatch(address)
    name = match[1] if match else address
    pace = float(match[2]) if match else None
    path = current_registry().hooks.place(name) or Path(name)
    if not os.path.exists(path):  # of a path, the method raises where the name is too long
        raise NodegraphError(f"replay:{address}: there is no file {path}")
    return (_Packets if _has_packets(path) else _Take)(path, pace)


def _has_packets(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(len(MAGIC)) == MAGIC


class _Pace:
    """Waits until it is time."""

    def __init__(self, closed: Event) -> None:
        self._closed = closed
        self._start = time.perf_counter()

    def wait(self, seconds: float) -> bool:
        """Wait until a time after the start; return whether the replay continues."""
        left = seconds - (time.perf_counter() - self._start)
        left = min(left, TIMEOUT_MAX)
        return not (self._closed.wait(left) if left > 0 else self._closed.is_set())


class _Take:
    """A whole value, frame by frame."""

    def __init__(self, path: Path, pace: float | None) -> None:
        self._path = path
        self._pace = pace
        self._closed = Event()

    @cached_property
    def _value(self) -> object:
        return read_streamable(self._path)

    @cached_property
    def _payloads(self) -> Sequence[object]:
        return streamable_of(type(self._value)).split(self._value)

    @cached_property
    def _header(self) -> object:
        return header_of(self._value)

    def open(self) -> object:
        self._closed.clear()
        return self._header

    def packets(self) -> Iterator[bytes]:
        rate = getattr(self._value, "rate", 0.0) if self._pace is None else self._pace
        pace = _Pace(self._closed)
        for index in range(len(self._payloads)):
            if not pace.wait(index / rate if rate else 0.0):
                return
            yield _INDEX.pack(index)

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        if header is not self._header:
            changed = difference(self._header, header, name="header")
            if changed:
                raise NodegraphError(f"{self._path}: is another than was recorded: {changed}")
            self._header = header
        if len(packet) != _INDEX.size:
            raise ValueError(f"{len(packet)} bytes, not {_INDEX.size}")
        (index,) = _INDEX.unpack(packet)
        if not 0 <= index < len(self._payloads):
            raise ValueError(f"frame {index} of {len(self._payloads)}")
        rate = getattr(header, "rate", 0.0)
        captured = round(index / rate * 1e9) if rate else 0
        return (Frame(index, captured, arrived, self._payloads[index]),)

    def close(self) -> None:
        self._closed.set()


class _Packets:
    """Recorded packets, decoded by the source that received them.

    Where that source was connected again, the replay ends as a lost connection does, so that what
    follows happens again as well.
    """

    def __init__(self, path: Path, pace: float | None) -> None:
        self._path = path
        self._reader = PacketFileReader(path)
        self._pace = pace
        self._rest = self._reader.packets()
        self._next: tuple[bool, int, bytes] | None = None
        self._closed = Event()

    @cached_property
    def _decoder(self) -> Source:
        """The source of the packets; behind recorded replays, that of the first recording."""
        decoder, seen = source_of(self._reader.source), {self._path.resolve()}
        while isinstance(decoder, _Packets):
            path = decoder._path.resolve()
            if path in seen:
                raise NodegraphError(f"{path} is the source of its own packets")
            seen.add(path)
            decoder = source_of(decoder._reader.source)
        return decoder

    def open(self) -> object:
        self._closed.clear()
        with self._naming_file():
            _ = self._decoder
        return self._reader.header

    def packets(self) -> Iterator[bytes]:
        pace = _Pace(self._closed)
        start: int | None = None
        first = [self._next] if self._next else []
        self._next = None
        for count, (reopened, arrived, packet) in enumerate(chain(first, self._rest)):
            if reopened:
                self._next = False, arrived, packet
                raise ConnectionResetError("the source was connected again here")
            start = arrived if start is None else start
            if self._pace is None:
                due = (arrived - start) / 1e9
            else:
                due = count / self._pace if self._pace else 0.0
            if not pace.wait(due):
                return
            yield packet

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        with self._naming_file():
            return self._decoder.frames(packet, arrived, header)

    def close(self) -> None:
        self._closed.set()

    @contextmanager
    def _naming_file(self) -> Iterator[None]:
        """Say of errors of what the file names that they are of the file."""
        try:
            yield
        except NodegraphError as error:
            raise self._reader.damage(error) from error


class FileSink:
    """Collects frames, and writes them at the end in the format that a file's suffix names.

    Frames that were dropped before one are missing in the file. Where numbers go back, or jump by
    more than `JUMP`, another file begins: ``filled_2.npz`` after ``filled.npz``.

    Parameters
    ----------
    address
        A path; a file that exists is not written over.
    """

    def __init__(self, address: str) -> None:
        self._path = Path(address)
        if self._path.exists():
            raise NodegraphError(f"{address} already exists; name another file")
        self._header: object = None
        self._missing: object = None
        self._takes: list[list[object]] = []
        self._expected = 0

    def open(self, header: object) -> None:
        """Begin a value.

        Raises
        ------
        NodegraphError
            If a value of that type cannot be written in the format that the path names.
        """
        formats = exporters_of(header, current_registry())
        if self._path.suffix.lower() not in formats:
            instead = (
                f"as {self._path.suffix}, but {listed(sorted(formats))}" if formats else "to a file"
            )
            raise NodegraphError(
                f"{self._path}: a value of type {type(header).__name__} cannot be written {instead}"
            )
        self._header = header
        self._missing = streamable_of(type(header)).missing(header)

    def write(self, frame: Frame) -> None:
        """Keep a frame."""
        absent = frame.index - self._expected
        if not self._takes or not 0 <= absent <= JUMP:
            self._takes.append([])
        else:
            self._takes[-1] += repeat(self._missing, absent)
        self._takes[-1].append(frame.payload)
        self._expected = frame.index + 1

    def close(self) -> None:
        """Write the files, unless the sink could not be opened."""
        if self._header is None:
            return
        self._write(self._path, self._takes[0] if self._takes else [])
        for number, payloads in enumerate(self._takes[1:], 2):
            path = self._path.with_stem(f"{self._path.stem}_{number}")
            self._write(path, payloads)
            warnings.warn(f"the stream restarted; what follows is in {path}", stacklevel=2)

    def _write(self, path: Path, payloads: Sequence[object]) -> None:
        value = streamable_of(type(self._header)).join(self._header, payloads)
        export = exporters_of(value, current_registry())[path.suffix.lower()]
        try:
            content = next(iter(export().values()))
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("xb") as file:
                file.write(content)
        except (OSError, ValueError) as error:
            raise NodegraphError(f"{path}: {message_of(error)}") from error


def read_streamable(path: Path) -> object:
    """Return the value of a file, by the first reader that can read it and gives frames.

    Readers are the nodes of the family ``read`` that require nothing but a file.

    Raises
    ------
    NodegraphError
        If none can, with the reason of each.
    """
    reasons = []
    for entry in current_registry().family("read").values():
        setting = _only_file(entry.node)
        if setting:
            try:
                return entry.node.function(**{setting: path})
            except (ValueError, NodegraphError, OSError) as error:
                reasons.append(f"{entry.node.name}: {message_of(error)}")
    raise NodegraphError(f"{path}: cannot be replayed: {'; '.join(reasons) or 'no reader'}")


def _only_file(node: Node) -> str:
    """Return the setting that names the file, if a node reads one and gives what is streamable."""
    streamable = tuple(kind.type for kind in current_registry().hooks.having("stream"))
    output = node.outputs[0]
    required = [setting for setting in node.settings.values() if setting.required]
    if node.inputs or node.splits or output.truth or len(required) != 1:
        return ""
    is_reader = required[0].is_file and issubclass(output.type, streamable)
    return required[0].name if is_reader else ""
