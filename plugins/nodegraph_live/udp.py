"""Frames of markers or weights over UDP, in a format of this package's own.

A packet is a header of 32 bytes and what follows it; numbers begin with their lowest byte.

| byte | what |
|---|---|
| 0 | ``NGL1`` |
| 4 | kind, 1 byte: 0 description, 1 frame, 2 end of the stream |
| 5 | bytes of a number in a frame, 1 byte: 4 or 8 |
| 6 | zero, 2 bytes |
| 8 | stream, 4 bytes: CRC-32 of what follows the header in the description |
| 12 | CRC-32 of the packet with these 4 bytes zero |
| 16 | number of the frame, 8 bytes |
| 24 | nanoseconds on the sender's clock when the frame was captured, 8 bytes with sign, or 0 |

A description is JSON in UTF-8: ``{"markers": [names], "rate": 240.0, "started": 1}``, or
``weights`` in place of ``markers``; ``started`` is another number each time that the sender is
started. It is sent at the start and about four times per second. A frame is x, y and z of each
marker in millimetres, or the weights, as float32 or float64; NaN where one is missing. All of it
must fit into one packet: 2700 markers as float64.
"""

from __future__ import annotations

import json
import struct
import time
import zlib
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from nodegraph import Frame, NodegraphError, quoted
from nodegraph_live.address import Settings
from nodegraph_live.datagrams import TIMEOUT, DatagramSink, DatagramSource
from nodegraph_live.payloads import (
    count_of_numbers,
    names_of,
    numbers_of,
    payload_of,
    recording_header,
    recording_or_weights,
    weights_header,
)
from nodegraph_mocap import Trajectories, Weights
from nodegraph_mocap.checks import FASTEST, SLOWEST

PORT = 51140
_HEAD = struct.Struct("<4sBBHIIQq")
_MAGIC = b"NGL1"
_DESCRIPTION, _FRAME, _END = range(3)
_FRAME_KIND = bytes([_FRAME])
_LARGEST = 65507  # bytes in a UDP packet
_FLOATS: dict[int, np.dtype[np.generic]] = {4: np.dtype("<f4"), 8: np.dtype("<f8")}


class _Packet(NamedTuple):
    kind: int
    width: int
    stream: int
    number: int
    captured: int
    content: memoryview


def encode(kind: int, content: bytes, *, width: int, stream: int, index: int, at: int) -> bytes:
    """Return a packet."""
    head = _HEAD.pack(_MAGIC, kind, width, 0, stream, 0, index, at)
    check = zlib.crc32(content, zlib.crc32(head))
    return _HEAD.pack(_MAGIC, kind, width, 0, stream, check, index, at) + content


def decode(packet: bytes) -> _Packet:
    """Return the parts of a packet; a damaged one is a ValueError."""
    if len(packet) < _HEAD.size or packet[:4] != _MAGIC:
        raise ValueError("it does not begin with NGL1")
    _, kind, width, zero, stream, check, index, captured = _HEAD.unpack_from(packet)
    content = memoryview(packet)[_HEAD.size :]
    bare = _HEAD.pack(_MAGIC, kind, width, zero, stream, 0, index, captured)
    if zlib.crc32(content, zlib.crc32(bare)) != check:
        raise ValueError("its checksum is wrong")
    if kind > _END or width not in _FLOATS or zero:
        raise ValueError(f"kind {kind} with numbers of {width} bytes is unknown")
    return _Packet(kind, width, stream, index, captured, content)


def decode_description(content: memoryview) -> Trajectories | Weights:
    """Return the header that a description gives; a wrong one is a ValueError."""
    try:
        fields = json.loads(bytes(content))
    except (ValueError, RecursionError):
        raise ValueError("the description is not JSON in UTF-8") from None
    if not isinstance(fields, dict):
        raise ValueError(f"the description is no object with names and a rate: {quoted(fields)}")
    rate = fields.get("rate")
    if not isinstance(rate, int | float) or not SLOWEST <= rate <= FASTEST:
        raise ValueError(f"the rate of the description is no rate in Hz: {quoted(rate)}")
    kinds = {"markers", "weights"} & fields.keys()
    if len(kinds) != 1:
        raise ValueError("the description has not either markers or weights")
    names = fields[min(kinds)]
    if not (isinstance(names, list) and all(isinstance(name, str) for name in names)):
        raise ValueError("the names of the description are not a list of texts")
    return (recording_header if "markers" in kinds else weights_header)(names, float(rate))


def _check_same(content: memoryview, header: Trajectories | Weights) -> None:
    """Refuse a description that does not give the header, which is a ValueError."""
    described = decode_description(content)
    if _key(described) != _key(header):
        raise ValueError("a description of another stream: other names, or another rate")


def _key(header: Trajectories | Weights) -> tuple[object, ...]:
    return type(header), names_of(header), header.rate


class UdpSource(DatagramSource):
    """Receives the packets of `UdpSink`, or of any program that sends such: ``udp:[HOST:]PORT``."""

    def __init__(self, address: str) -> None:
        form = "udp:[HOST:]PORT[?timeout=SECONDS]"
        settings = Settings("udp", address, form, {"timeout": TIMEOUT})
        super().__init__(settings, PORT, "description of a stream NGL1")
        self._header: Trajectories | Weights
        self._stream = -1
        self._restart = b""
        """The description by which a sender that was started again was noticed."""

    def open(self) -> Trajectories | Weights:
        """Wait for a description."""
        self._bind()
        if self._restart:
            self._first, self._restart = [self._restart], b""
        else:
            self._header = self._wait_for_header()
        return self._header

    def describe(self, packet: bytes) -> Trajectories | Weights | None:
        """Return the header if the packet is a description."""
        parts = decode(packet)
        if parts.kind != _DESCRIPTION:
            return None
        del self._first[:-1]  # frames before it may be of another stream
        return decode_description(parts.content)

    def packets(self) -> Iterator[bytes]:
        """Yield packets until the sender ends the stream.

        A description of other names or another rate is of another sender, and ends nothing.

        Raises
        ------
        ConnectionResetError
            If the sender was started again: its frames count from the start.
        """
        stream = -1
        for packet in super().packets():
            if packet[4:5] == _FRAME_KIND:
                yield packet
                continue
            try:
                parts = decode(packet)
                if parts.kind == _DESCRIPTION:
                    _check_same(parts.content, self._header)
            except ValueError:
                yield packet  # is counted where frames are decoded
                continue
            if parts.kind == _END and parts.stream == stream:
                return
            if parts.kind == _DESCRIPTION and parts.stream != stream:
                if stream >= 0:
                    self._restart = packet
                    raise ConnectionResetError("the sender was started again")
                stream = parts.stream
            yield packet

    def frames(self, packet: bytes, arrived: int, header: object) -> Iterable[Frame]:
        """Return the frame in a packet, if it is one."""
        header = recording_or_weights(self._settings.address, header)
        kind, width, stream, number, captured, content = decode(packet)
        if kind == _DESCRIPTION:
            _check_same(content, header)
            self._stream = stream
        if kind != _FRAME:
            return ()
        if stream != self._stream:
            raise ValueError("it belongs to a stream of which no description has come")
        count = count_of_numbers(header)
        if len(content) != count * width:
            raise ValueError(f"{len(content)} bytes, not {count} numbers of {width} bytes")
        payload = payload_of(header, np.frombuffer(content, _FLOATS[width]))
        return (Frame(number, captured, arrived, payload),)


class UdpSink(DatagramSink):
    """Sends recordings or weights: ``udp:HOST:PORT``; with ``?bytes=8`` as float64."""

    def __init__(self, address: str) -> None:
        form = "udp:HOST[:PORT][?bytes=4 or 8]"
        settings = Settings("udp", address, form, {"bytes": 4})
        if settings["bytes"] not in _FLOATS:
            raise settings.error(f"no floats of {settings['bytes']:g} bytes")
        self._width = int(settings["bytes"])
        super().__init__(settings, PORT)
        self._description = b""

    def open(self, header: object) -> None:
        """Send the description."""
        header = recording_or_weights(self._settings.address, header)
        kind = "markers" if isinstance(header, Trajectories) else "weights"
        fields = {kind: names_of(header), "rate": header.rate, "started": time.time_ns()}
        content = json.dumps(fields, ensure_ascii=False).encode()
        size = _HEAD.size + max(count_of_numbers(header) * self._width, len(content))
        if size > _LARGEST:
            raise NodegraphError(
                f"{self._settings.address}: {len(names_of(header))} {kind} take {size} bytes; a "
                f"packet holds {_LARGEST}"
            )
        self.connect()
        self._stream = zlib.crc32(content)
        self._description = self._packet(_DESCRIPTION, content)
        self._until_described = self._period = max(round(header.rate / 4), 1)
        self.send(self._description)

    def write(self, frame: Frame) -> None:
        """Send a frame."""
        content = numbers_of(frame.payload).astype(_FLOATS[self._width]).tobytes()
        self.send(self._packet(_FRAME, content, frame.index, frame.captured))
        self._until_described -= 1
        if not self._until_described:
            self._until_described = self._period
            self.send(self._description)

    def close(self) -> None:
        """Send the end of the stream."""
        if self._description:
            with suppress(OSError):  # whoever receives notes the silence, too
                self.send(self._packet(_END, b""))
        super().close()

    def _packet(self, kind: int, content: bytes, index: int = 0, at: int = 0) -> bytes:
        return encode(kind, content, width=self._width, stream=self._stream, index=index, at=at)
