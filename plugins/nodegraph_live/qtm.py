"""Qualisys Track Manager: labelled markers by its real-time protocol, over TCP.

A message is its size (4 bytes, itself included), its type (4 bytes) and what follows; numbers
begin with their lowest byte at port 22223. Positions are float32 in millimetres, NaN where a
marker is missing. Source: the real-time server protocol of Qualisys, version 1.25.

Tested against an emulator of this package only, which the official client qtm-rt can read too;
not against QTM.
"""

from __future__ import annotations

import socket
import struct
from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import chain
from threading import Event
from time import monotonic
from typing import TYPE_CHECKING
from xml.etree import ElementTree

from nodegraph import Frame, NodegraphError, quoted
from nodegraph_live.address import Settings
from nodegraph_live.datagrams import TIMEOUT
from nodegraph_live.packet_reader import PacketReader
from nodegraph_live.payloads import marker_frame, recording_header, recording_only
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

PORT = 22223
ERROR, COMMAND, XML, DATA = range(4)
_MARKERS = 1
"""The component of labelled markers."""
_HEAD = struct.Struct("<ii")
_LARGEST = 16 << 20  # bytes of a message
_POLL = 0.2  # seconds


def encode(kind: int, content: bytes) -> bytes:
    """Return a message."""
    return _HEAD.pack(_HEAD.size + len(content), kind) + content


def decode_markers(
    message: bytes,
) -> tuple[int, int, NDArray[np.float64]]:
    """Return microseconds, frame number and (M, 3) millimetres of a message with data.

    Raises
    ------
    ValueError
        If it is damaged, or has no labelled markers.
    """
    reader = PacketReader(message)
    size, kind = reader.numbers("ii")
    if size != len(message) or kind != DATA:
        raise ValueError(f"a message of type {kind} and {size} bytes, no data of {len(message)}")
    time, number, components = reader.numbers("qii")
    for _ in range(min(components, reader.left)):
        length, component = reader.numbers("ii")
        content = PacketReader(reader.bytes(length - _HEAD.size))
        if component == _MARKERS:
            count = content.numbers("Ihh")[0]
            if content.left != 12 * count:
                raise ValueError(f"{count} markers in {content.left} bytes")
            return time, number, content.floats(3 * count).reshape(-1, 3)
    raise ValueError("no labelled markers")


def decode_parameters(xml: bytes) -> Trajectories:
    """Return the header that the parameters ``general`` and ``3d`` give.

    Raises
    ------
    ValueError
        If they are not XML, or state no rate or no markers.
    """
    try:
        root = ElementTree.fromstring(xml.rstrip(b"\0"))
        rate = float(root.findtext("./General/Frequency") or "nan")
    except ElementTree.ParseError as error:
        raise ValueError(f"the parameters are not XML: {error}") from error
    names = [label.findtext("Name") or "" for label in root.iterfind("./The_3D/Label")]
    return recording_header(names, rate)


class QtmSource:
    """Receives labelled markers from QTM: ``qtm:HOST``, or ``qtm:HOST:PORT`` for another port.

    Frames are numbered by QTM. All frames are asked for, not the newest only.
    """

    def __init__(self, address: str) -> None:
        form = "qtm:HOST[:PORT][?timeout=SECONDS], such as qtm:192.168.0.5"
        self._settings = Settings("qtm", address, form, {"timeout": TIMEOUT})
        self._target = self._settings.endpoint(PORT)
        self._closed = Event()
        self._endpoint: socket.socket | None = None
        self._first = b""
        self._messages: Iterator[tuple[int, bytes]] = iter(())

    def open(self) -> Trajectories:
        """Connect, ask for the names of the markers, and start the stream.

        Raises
        ------
        NodegraphError
            If nothing answers, there are no labelled markers, or nothing is measured.
        """
        self._closed.clear()
        deadline = monotonic() + self._settings["timeout"]
        lacking = "nobody listens there"
        while monotonic() < deadline and not self._closed.is_set():
            try:
                self._endpoint = socket.create_connection(self._target, timeout=1.0)
                self._endpoint.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._messages = self._receive(self._endpoint)
                lacking = "it does not speak QTM's protocol"
                self._ask("version 1.25", COMMAND)
                lacking = "it does not name its markers"
                header = decode_parameters(self._ask("getparameters general 3d", XML)[_HEAD.size :])
                lacking = "it sends no frames; start a measurement"
                self._first = self._ask("streamframes allframes 3d", DATA)
                return header
            except ValueError as error:
                self.close()
                raise NodegraphError(f"{self._settings.address}: {error}") from error
            except socket.gaierror as error:
                raise self._settings.error(f"no host {quoted(self._target[0])}: {error}") from error
            except OSError:
                self._disconnect()
                self._closed.wait(_POLL)
        self.close()
        raise NodegraphError(
            f"{self._settings.address}: no stream from {self._target[0]}:{self._target[1]} in "
            f"{self._settings['timeout']:g} s: {lacking}"
        )

    def packets(self) -> Iterator[bytes]:
        """Yield messages with data."""
        for kind, message in chain([(DATA, self._first)], self._messages):
            if kind == DATA:
                yield message

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the frame in a message."""
        header = recording_only(self._settings.address, header)
        time, number, positions = decode_markers(packet)
        if len(positions) != len(header.markers):
            raise ValueError(f"{len(positions)} markers, not {len(header.markers)}")
        payload = marker_frame(positions)
        return (Frame(number, 1000 * time, arrived, payload),)

    def close(self) -> None:
        """Disconnect."""
        self._closed.set()
        self._disconnect()

    def _disconnect(self) -> None:
        if self._endpoint is not None:
            with suppress(OSError):
                self._endpoint.shutdown(socket.SHUT_RDWR)
            self._endpoint.close()

    def _ask(self, command: str, wanted: int) -> bytes:
        """Send a command, and return the first message of that type that follows."""
        assert self._endpoint is not None
        self._endpoint.sendall(encode(COMMAND, command.encode() + b"\0"))
        for kind, message in self._messages:
            # the greeting comes before the first answer
            if kind == wanted and b"RT Interface connected" not in message:
                return message
            if kind == ERROR:
                text = message[_HEAD.size :].rstrip(b"\0").decode(errors="replace")
                raise ValueError(f"QTM answers {quoted(command)} with {quoted(text)}")
        raise ConnectionError("closed")

    def _receive(self, endpoint: socket.socket) -> Iterator[tuple[int, bytes]]:
        """Yield type and bytes of each message; an end of the connection is a ConnectionError."""
        endpoint.settimeout(_POLL)
        waiting = bytearray()
        deadline = monotonic() + self._settings["timeout"]
        while not self._closed.is_set():
            try:
                piece = endpoint.recv(1 << 16)
            except TimeoutError:
                if monotonic() > deadline:
                    raise TimeoutError(f"no message for {self._settings['timeout']:g} s") from None
                continue
            except OSError:
                if self._closed.is_set():
                    return
                raise
            if not piece and not self._closed.is_set():
                raise ConnectionError("QTM has closed the connection")
            deadline = monotonic() + self._settings["timeout"]
            waiting += piece
            while len(waiting) >= _HEAD.size:
                size, kind = _HEAD.unpack_from(waiting)
                if not _HEAD.size <= size <= _LARGEST:
                    raise ConnectionError(f"a message of {size} bytes: not QTM's protocol")
                if len(waiting) < size:
                    break
                message = bytes(waiting[:size])
                del waiting[:size]
                yield kind, message
