"""Open Sound Control 1.0: messages and bundles, of which VMC packets are made.

Numbers begin with their highest byte, and everything takes a multiple of four bytes.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator, Sequence

from nodegraph import quoted
from nodegraph_live.packet_reader import PacketReader

_BUNDLE = b"#bundle\0"
_AT_ONCE = struct.pack(">Q", 1)
_SIZE = struct.Struct(">i")
_DEEPEST = 4
_NUMBERS = {"i": "i", "f": "f", "d": "d", "h": "q", "t": "Q", "c": "i", "r": "I", "m": "I"}
_CONSTANTS = {"T": True, "F": False, "N": None, "I": float("inf")}

Message = tuple[str, tuple[object, ...]]
"""Address and arguments."""


def elements(packet: bytes) -> Iterator[bytes]:
    """Yield the messages of a packet, as they are, those of bundles in their order.

    Raises
    ------
    ValueError
        If the packet is damaged; messages before that place have been yielded.
    """
    if packet[:8] != _BUNDLE:
        yield packet
        return
    starts = [16]
    ends = [len(packet)]
    while starts:
        start, end = starts[-1], ends[-1]
        if start == end:
            starts.pop()
            ends.pop()
            continue
        place = start + 4
        if place > end or len(starts) > _DEEPEST:
            raise ValueError("a bundle ends in the middle of a message, or lies too deep")
        (size,) = _SIZE.unpack_from(packet, start)
        if not 0 <= size <= end - place:
            raise ValueError(f"a message of {size} bytes, but {end - place} are left")
        starts[-1] = place + size
        if packet[place : place + 8] == _BUNDLE and size >= 16:
            starts.append(place + 16)
            ends.append(place + size)
        else:
            yield packet[place : place + size]


def decode(element: bytes) -> Message:
    """Return address and arguments of a message.

    Raises
    ------
    ValueError
        If it is damaged.
    """
    reader = PacketReader(element, ">")
    address, tags = _text(reader), _text(reader)
    if not (address.startswith("/") and tags.startswith(",")):
        raise ValueError("it is not an OSC message")
    return address, tuple([_argument(reader, tag) for tag in tags[1:]])


def _argument(reader: PacketReader, tag: str) -> object:
    if tag in _NUMBERS:
        return reader.numbers(_NUMBERS[tag])[0]
    if tag in "sS":
        return _text(reader)
    if tag == "b":
        (size,) = reader.numbers("i")
        content = reader.bytes(size)
        reader.skip(-size % 4)
        return content
    if tag in _CONSTANTS:
        return _CONSTANTS[tag]
    raise ValueError(f"an argument of the unknown type {quoted(tag)}")


def _text(reader: PacketReader) -> str:
    text = reader.text(reader.left)
    reader.skip(-(len(text.encode()) + 1) % 4)
    return text


def message(address: str, *arguments: str | float | int) -> bytes:
    """Return a message; texts, float32 and int32 are its arguments."""
    tags, content = ",", b""
    for argument in arguments:
        if isinstance(argument, str):
            tags, content = f"{tags}s", content + _padded(argument)
        elif isinstance(argument, int):
            tags, content = f"{tags}i", content + struct.pack(">i", argument)
        else:
            tags, content = f"{tags}f", content + struct.pack(">f", argument)
    return _padded(address) + _padded(tags) + content


def bundles(messages: Iterable[bytes], largest: int) -> Sequence[bytes]:
    """Return the messages in bundles of limited size, in their order."""
    packets = [bytearray(_BUNDLE + _AT_ONCE)]
    for each in messages:
        if len(packets[-1]) + 4 + len(each) > largest:
            packets.append(bytearray(_BUNDLE + _AT_ONCE))
        packets[-1] += _SIZE.pack(len(each)) + each
    return [bytes(packet) for packet in packets]


def _padded(text: str) -> bytes:
    content = text.encode() + b"\0"
    return content + bytes(-len(content) % 4)
