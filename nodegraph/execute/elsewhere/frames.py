"""Lists of bytes over a pipe: how many, how long each, then the bytes themselves."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from io import BufferedReader, BufferedWriter

import numpy as np

Frame = bytes | memoryview

_COUNT = struct.Struct("<I")


def write_frames(stream: BufferedWriter, frames: Sequence[Frame]) -> None:
    """Write a list of bytes; large ones are not copied."""
    sizes = [len(one) for one in frames]
    stream.write(_COUNT.pack(len(frames)) + struct.pack(f"<{len(frames)}Q", *sizes))
    for one in frames:
        stream.write(one)
    stream.flush()


def read_frames(stream: BufferedReader) -> list[Frame]:
    """Read a list of bytes.

    Raises
    ------
    EOFError
        If the other side is gone.
    """
    (count,) = _COUNT.unpack(_read(stream, _COUNT.size))
    sizes = struct.unpack(f"<{count}Q", _read(stream, 8 * count))
    return [_read(stream, size) for size in sizes]


def _read(stream: BufferedReader, size: int) -> memoryview:
    # not a bytearray, which would be filled with zeros first
    buffer = np.empty(size, np.uint8).data
    rest = buffer
    while rest.nbytes:
        got = stream.readinto(rest)
        if not got:
            raise EOFError
        rest = rest[got:]
    return buffer.toreadonly()
