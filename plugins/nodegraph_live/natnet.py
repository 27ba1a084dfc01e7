"""NatNet: marker sets as OptiTrack Motive streams them, over UDP.

A packet is a message number and the size of what follows (2 bytes each). Numbers begin with their
lowest byte, texts end with a zero byte, positions are float32 in metres. Read are protocol 3.0 and
later (Motive 2.0 and later); the natnet package 0.3 served as a second reading of the format.

Tested against an emulator of this package only, not against Motive.
"""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from time import monotonic
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import Frame, NodegraphError, quoted
from nodegraph_live.address import Settings
from nodegraph_live.datagrams import TIMEOUT, DatagramReceiver, datagram_socket, resolved
from nodegraph_live.packet_reader import PacketReader
from nodegraph_live.payloads import marker_frame, recording_header, recording_only
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

PORT = 1510
CONNECT, SERVER, REQUEST, RESPONSE, ASK_MODEL, MODEL, _, FRAME, _, _, KEEP_ALIVE = range(11)
_MODEL_TYPES = 16
_METRES = 1000.0  # mm
_ALL = "all"
"""The marker set in which Motive repeats the markers of all others."""

Version = tuple[int, int]
MarkerSets = dict[str, tuple[str, ...]]


class Server(NamedTuple):
    """The description that a server gives of itself."""

    name: str
    protocol: Version


class MarkerFrameData(NamedTuple):
    """A frame: its number, seconds since the stream began, metres by marker set."""

    number: int
    seconds: float
    positions: dict[str, NDArray[np.float64]]


def decode_message(packet: bytes) -> tuple[int, PacketReader]:
    """Return the number of a message and its content; a damaged packet is a ValueError."""
    reader = PacketReader(packet)
    number, size = reader.numbers("HH")
    if size != reader.left:
        raise ValueError(f"a message of {size} bytes, but {reader.left} follow")
    return number, reader


def encode_message(number: int, content: bytes = b"") -> bytes:
    """Return a packet."""
    return struct.pack("<HH", number, len(content)) + content


def decode_server(reader: PacketReader) -> Server:
    """Return what a server says of itself."""
    name = reader.bytes(256).partition(b"\0")[0].decode()
    major, minor = reader.numbers("8B")[4:6]
    return Server(name, (major, minor))


def decode_model(reader: PacketReader, protocol: Version) -> MarkerSets:
    """Return the markers of each marker set.

    Before protocol 4.1 other descriptions have no size, so that only marker sets before the first
    of them are read: Motive sends these first.

    Raises
    ------
    ValueError
        If a description is of an unknown kind, or the packet ends within it.
    """
    marker_sets: MarkerSets = {}
    (count,) = reader.numbers("I")
    for _ in range(min(count, reader.left)):
        (kind,) = reader.numbers("I")
        if kind >= _MODEL_TYPES:
            raise ValueError(f"a description of the unknown kind {kind}")
        size = reader.numbers("I")[0] if protocol >= (4, 1) else None
        if kind == 0:
            name, (markers,) = reader.text(), reader.numbers("I")
            marker_sets[name] = tuple([reader.text() for _ in range(min(markers, reader.left + 1))])
        elif size is None:
            break
        else:
            reader.skip(size)
    return marker_sets


def decode_frame(reader: PacketReader, protocol: Version) -> MarkerFrameData:
    """Return the marker sets of a frame, in metres; whatever else is in it is passed over.

    Raises
    ------
    ValueError
        If the packet ends too early, or its time is negative or beyond 1e9 s.
    """
    has_sizes = protocol >= (4, 1)
    (number,) = reader.numbers("i")
    count = reader.numbers("II")[0] if has_sizes else reader.numbers("I")[0]
    positions = {}
    for _ in range(min(count, reader.left)):
        name, (markers,) = reader.text(), reader.numbers("I")
        positions[name] = reader.floats(3 * markers).reshape(-1, 3)
    if has_sizes:
        # other markers, rigid bodies, skeletons, assets, labelled markers, force plates, devices
        for _ in range(7):
            reader.skip(reader.numbers("II")[1])
    else:
        _skip_unsized(reader)
    seconds = reader.numbers("IId")[2]
    if not 0 <= seconds < 1e9:
        raise ValueError(f"a time of {seconds} s")
    return MarkerFrameData(number, seconds, positions)


def _skip_unsized(reader: PacketReader) -> None:
    """Pass over what follows the marker sets in protocols 3.0 to 4.0."""
    reader.skip(12 * reader.numbers("I")[0])  # other markers
    reader.skip(38 * reader.numbers("I")[0])  # rigid bodies
    for _ in range(min(reader.numbers("I")[0], reader.left)):  # skeletons
        reader.skip(38 * reader.numbers("II")[1])
    reader.skip(26 * reader.numbers("I")[0])  # labelled markers
    for _ in range(2):  # force plates, devices
        for _ in range(min(reader.numbers("I")[0], reader.left)):
            for _ in range(min(reader.numbers("II")[1], reader.left)):
                reader.skip(4 * reader.numbers("I")[0])


def marker_names(marker_sets: MarkerSets) -> tuple[str, ...]:
    """Return names for the markers of all sets; those that are in several sets, with the set's."""
    sets = _wanted(marker_sets)
    counts = Counter(name for names in sets.values() for name in names)
    return tuple(
        name if counts[name] == 1 else f"{each}:{name}"
        for each, names in sets.items()
        for name in names
    )


def _wanted(marker_sets: MarkerSets) -> MarkerSets:
    others = {name: markers for name, markers in marker_sets.items() if name != _ALL}
    return others if any(others.values()) else marker_sets


class NatNetSource(DatagramReceiver):
    """Receives marker sets from Motive: ``natnet:HOST``, or ``natnet:HOST:PORT`` for commands.

    Motive's streaming is set to unicast. A marker at exactly (0, 0, 0) is missing.
    """

    def __init__(self, address: str) -> None:
        form = "natnet:HOST[:PORT][?timeout=SECONDS][&rate=HZ], such as natnet:192.168.0.5"
        super().__init__(Settings("natnet", address, form, {"timeout": TIMEOUT, "rate": 0.0}))
        self._target = self._settings.endpoint(PORT)
        self._first: list[bytes] = []
        self._protocol: Version | None = None
        self._marker_sets: MarkerSets = {}

    def open(self) -> Trajectories:
        """Ask for the server's version, rate and marker sets, and wait for a frame."""
        self._closed.clear()
        self._first = []
        self._protocol, self._marker_sets = None, {}
        self._address = resolved(self._settings, *self._target)
        self._endpoint = datagram_socket()
        rate = self._settings["rate"]
        deadline = monotonic() + self._settings["timeout"]
        with suppress(TimeoutError):
            for packet in self._receive(self._ask):
                if monotonic() > deadline:
                    break
                try:
                    number, content = decode_message(packet)
                    if number == RESPONSE and not rate and content.left == 4:
                        rate = max(float(content.numbers("f")[0]), 0.0)
                    self._learn(number, content)
                except ValueError:
                    continue
                if number in (SERVER, MODEL):
                    self._first.append(packet)
                if self._marker_sets and rate:
                    return self._header(rate)
        self.close()
        raise NodegraphError(f"{self._settings.address}: {self._what_is_lacking(rate)}")

    def packets(self) -> Iterator[bytes]:
        """Yield what the server sends; five times per second it hears that we listen."""
        yield from self._first
        yield from self._receive(lambda: self._send(encode_message(KEEP_ALIVE, b"\0")))

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the frame in a packet, if it is one."""
        header = recording_only(self._settings.address, header)
        number, reader = decode_message(packet)
        if number != FRAME:
            self._learn(number, reader, header)
            return ()
        if self._protocol is None or not self._marker_sets:
            raise ValueError("a frame before the description of the marker sets")
        data = decode_frame(reader, self._protocol)
        parts = []
        for name, markers in _wanted(self._marker_sets).items():
            if len(data.positions.get(name, ())) != len(markers):
                raise ValueError(
                    f"marker set {quoted(name)} has {len(data.positions.get(name, ()))} markers, "
                    f"not {len(markers)}"
                )
            if markers:
                parts.append(data.positions[name])
        positions = np.concatenate(parts) * _METRES
        if len(positions) != len(header.markers):
            raise ValueError(f"{len(positions)} markers, not {len(header.markers)}")
        captured = round(data.seconds * 1e9)
        payload = marker_frame(positions, zeros_missing=True)
        return (Frame(data.number, captured, arrived, payload),)

    def _ask(self) -> None:
        if self._protocol is None:
            self._send(encode_message(CONNECT, b"Ping\0"))
        else:
            self._send(encode_message(REQUEST, b"FrameRate\0"))
            self._send(encode_message(ASK_MODEL, b"\0"))

    def _send(self, packet: bytes) -> None:
        assert self._endpoint is not None
        with suppress(OSError):  # the network may come back; silence has its own limit
            self._endpoint.sendto(packet, self._address)

    def _learn(self, number: int, reader: PacketReader, header: Trajectories | None = None) -> None:
        """Take version and marker sets from a message, if it has any.

        Raises
        ------
        ValueError
            If they are of another server: of another version than is known, or without the markers
            of the header.
        """
        if number == SERVER:
            protocol = decode_server(reader).protocol
            if self._protocol not in (None, protocol):
                raise ValueError(f"an answer by protocol {protocol}, after one by {self._protocol}")
            self._protocol = protocol
        elif number == MODEL and self._protocol is not None:
            marker_sets = decode_model(reader, self._protocol)
            if header is not None and marker_names(marker_sets) != header.markers:
                raise ValueError("a description of other markers")
            self._marker_sets = marker_sets

    def _header(self, rate: float) -> Trajectories:
        if self._protocol is not None and self._protocol < (3, 0):
            self.close()
            raise NodegraphError(
                f"{self._settings.address}: protocol {self._protocol[0]}.{self._protocol[1]}; "
                "protocols from 3.0 (Motive 2.0) are read"
            )
        try:
            return recording_header(marker_names(self._marker_sets), rate)
        except ValueError as error:
            self.close()
            raise NodegraphError(f"{self._settings.address}: {error}") from error

    def _what_is_lacking(self, rate: float) -> str:
        host, port = self._target
        seconds = f"in {self._settings['timeout']:g} s"
        if self._protocol is None:
            return (
                f"no server at {host}:{port} has answered {seconds}; in Motive, turn streaming on "
                "and set it to unicast"
            )
        if not self._marker_sets:
            return f"the server has described no marker sets {seconds}; stream them in Motive"
        assert not rate
        return f"the server has not sent its rate {seconds}; add ?rate=HZ to the address"
