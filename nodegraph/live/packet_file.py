"""Raw packets of a stream in a file, so that it can be replayed as it was received."""

from __future__ import annotations

import json
import struct
import warnings
from collections.abc import Iterator
from io import BufferedWriter
from pathlib import Path

from nodegraph.errors import NodegraphError
from nodegraph.plugin.formats import current_registry
from nodegraph.store import Packer

MAGIC = b"nodegraph packets 1\n"
_RECORD = struct.Struct("<?qI")
"""Whether the source was opened again before it, when the packet arrived in ns, and its length."""


class PacketFileWriter:
    """Writes the packets of a source into a file, which must not exist.

    Parameters
    ----------
    path
    address
        Of the source, ``scheme:address``: it decodes the packets again.

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
            packed = Packer(current_registry().hooks.storages).pack(header)
            sizes = [len(buffer) for buffer in packed.buffers]
            head = {"source": self._address, "header": packed.head, "sizes": sizes}
            self._put(MAGIC + json.dumps(head).encode() + b"\n" + b"".join(packed.buffers))

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
        What it returned when it was opened.

    Raises
    ------
    NodegraphError
        If the file is damaged, or its header is of a type that no plugin defines.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            with path.open("rb") as file:
                file.read(len(MAGIC))
                head = json.loads(file.readline())
                buffers = [file.read(size) for size in head["sizes"]]
                self.source: str = head["source"]
                packer = Packer(current_registry().hooks.storages)
                self.header = packer.unpack(head["header"], buffers)
                self._start = file.tell()
        except (NodegraphError, ValueError, KeyError, TypeError) as error:
            raise NodegraphError(f"{path}: is damaged: {error}") from error

    def packets(self) -> Iterator[tuple[bool, int, bytes]]:
        """Yield whether the source was opened again before, the arrival in ns, and the packet.

        A packet that the end of the file cuts off is left out, with a warning.
        """
        with self._path.open("rb") as file:
            file.seek(self._start)
            while record := file.read(_RECORD.size):
                if len(record) == _RECORD.size:
                    reopened, arrived, size = _RECORD.unpack(record)
                    packet = file.read(size)
                    if len(packet) == size:
                        yield reopened, arrived, packet
                        continue
                warnings.warn(f"{self._path}: ends in the middle of a packet", stacklevel=2)
                return
