"""Raw packets of a stream in a file, so that it can be replayed as it was received."""

from __future__ import annotations

import struct
import warnings
from collections.abc import Iterator
from io import BufferedReader, BufferedWriter
from pathlib import Path

from pydantic import BaseModel, ConfigDict, NonNegativeInt, ValidationError

from nodegraph.errors import NodegraphError
from nodegraph.live.forms import header_of
from nodegraph.plugin.formats import current_registry
from nodegraph.store import Packer
from nodegraph.validation_errors import first_error

MAGIC = b"nodegraph packets 1\n"
_RECORD = struct.Struct("<BqI")
"""Whether the source was opened again before it, when the packet arrived in ns, and its length."""
_LONGEST_PAUSE = 24 * 3600 * 10**9
"""Nanoseconds between two packets of a connection; with more, a time of arrival is wrong."""


class _Head(BaseModel):
    """The line that follows the first one.

    Attributes
    ----------
    source : str
        The address of the source.
    header : str
        The value that the source returned when it was opened, as a `Packer` writes it.
    sizes : list of int
        Sizes of the buffers that belong to it, in bytes; they follow this line, and packets follow
        them.
    """

    model_config = ConfigDict(strict=True, extra="forbid")

    source: str
    header: str
    sizes: list[NonNegativeInt]


class PacketFileWriter:
    """Writes the packets of a source into a file, which must not exist.

    Parameters
    ----------
    path
    address
        The address of the source, ``scheme:address``: it decodes the packets again.

    Raises
    ------
    NodegraphError
        If the file exists; later, if it cannot be written.
    """

    def __init__(self, path: Path, address: str) -> None:
        if path.exists():
            raise NodegraphError(f"{path} already exists; name another file")
        self._path = path
        self._address = address
        self._file: BufferedWriter | None = None
        self._is_reopened = False

    def note_opening(self, header: object) -> None:
        """Note that the source was opened; the first time, begin the file."""
        self._is_reopened = self._file is not None
        if self._file is None:
            packed = Packer(current_registry().hooks.kinds).pack(header)
            sizes = [len(buffer) for buffer in packed.buffers]
            head = _Head(source=self._address, header=packed.head, sizes=sizes)
            line = head.model_dump_json().encode()
            self._put(MAGIC + line + b"\n" + b"".join(packed.buffers))

    def write(self, packet: bytes, arrived: int) -> None:
        """Write a packet."""
        self._put(_RECORD.pack(self._is_reopened, arrived, len(packet)) + packet)
        self._is_reopened = False

    def close(self) -> None:
        """Finish the file, if there is one; a disk that takes no more is a NodegraphError."""
        if self._file is not None:
            try:
                self._file.close()
            except OSError as error:
                raise self._failure(error) from error

    def _put(self, content: bytes) -> None:
        try:
            if self._file is None:
                self._file = self._path.open("xb")
            self._file.write(content)
        except OSError as error:
            # an OSError of its own would pass for one of the source
            raise self._failure(error) from error

    def _failure(self, error: OSError) -> NodegraphError:
        return NodegraphError(f"{self._path}: cannot be written: {error.strerror}")


class PacketFileReader:
    """Reads what a `PacketFileWriter` wrote.

    Attributes
    ----------
    source : str
        The address of the source that received the packets.
    header : value
        The value that it returned when it was opened.

    Raises
    ------
    NodegraphError
        If the file is damaged, or its header is of a type that no plugin defines.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._size = path.stat().st_size
        with path.open("rb") as file:
            file.read(len(MAGIC))
            line = file.readline()
            try:
                head = _Head.model_validate_json(line)
                buffers = [self._read(file, size) for size in head.sizes]
                packer = Packer(current_registry().hooks.kinds)
                self.header = header_of(packer.unpack(head.header, buffers))
            except ValidationError as error:
                raise self.damage(first_error(error, {})) from error
            except NodegraphError as error:
                cause = error.__cause__ or error
                # other errors speak of Python, not of what was written
                is_said = type(cause) in (ValueError, type(error))
                reason = cause if is_said else "it is not what such a file begins with"
                raise self.damage(f"header: {reason}") from error
            self.source = head.source
            self._start = file.tell()

    def packets(self) -> Iterator[tuple[bool, int, bytes]]:
        """Yield whether the source was opened again before, the arrival in ns, and the packet.

        A packet that the end of the file cuts off is left out, with a warning.

        Raises
        ------
        NodegraphError
            If what stands before a packet cannot be right.
        """
        last: int | None = None
        with self._path.open("rb") as file:
            file.seek(self._start)
            while record := file.read(_RECORD.size):
                if len(record) == _RECORD.size:
                    reopened, arrived, size = _RECORD.unpack(record)
                    pause = 0 if last is None else arrived - last
                    if reopened > 1 or pause < 0 or (pause > _LONGEST_PAUSE and not reopened):
                        place = file.tell() - _RECORD.size
                        raise self.damage(f"no packet begins at byte {place}")
                    last = arrived
                    packet = self._read(file, size)
                    if len(packet) == size:
                        yield bool(reopened), arrived, packet
                        continue
                warnings.warn(f"{self._path}: ends in the middle of a packet", stacklevel=2)
                return

    def damage(self, reason: object) -> NodegraphError:
        """Return an error that says what of the file cannot be right."""
        return NodegraphError(f"{self._path}: is damaged: {reason}")

    def _read(self, file: BufferedReader, size: int) -> bytes:
        """Return so many bytes, or those that are left, which takes no more memory than these."""
        return file.read(min(size, self._size - file.tell()))
