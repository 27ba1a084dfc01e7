"""C3D files made byte by byte, so that a file can also be wrong."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

BLOCK = 512
Entry = tuple[str, Any]


def group(name: str, number: int) -> bytes:
    text = name.encode()
    return bytes([len(text), 256 - number]) + text + struct.pack("<HB", 3, 0)


def parameter(name: str, number: int, value: Any) -> bytes:
    kind, shape, data = encoded(value)
    body = struct.pack("<bB", kind, len(shape)) + bytes(shape) + data + b"\0"
    text = name.encode()
    return bytes([len(text), number]) + text + struct.pack("<H", len(body) + 2) + body


def encoded(value: Any) -> tuple[int, list[int], bytes]:
    if isinstance(value, list):
        raw = [text if isinstance(text, bytes) else text.encode() for text in value]
        width = max((len(text) for text in raw), default=0)
        return -1, [width, len(raw)], b"".join(text.ljust(width) for text in raw)
    if isinstance(value, str):
        return -1, [len(value)], value.encode()
    if isinstance(value, float):
        return 4, [], struct.pack("<f", value)
    return 2, [], struct.pack("<H", value)


def build(
    samples: NDArray[np.float32],
    labels: list[Any] | None = None,
    *,
    rate: float = 60.0,
    header: Mapping[int, bytes] | None = None,
    **changed: Any,
) -> bytes:
    """Return a C3D file: (T, M, 4) samples x, y, z, residual.

    `header` replaces bytes of the header by their place; `changed` sets POINT parameters, or
    leaves them out (None).
    """
    frames, points = samples.shape[:2]
    names = [f"m{index}" for index in range(points)] if labels is None else labels
    point: dict[str, Any] = {
        "USED": points,
        "SCALE": -1.0,
        "RATE": rate,
        "DATA_START": 0,
        "FRAMES": frames,
        "LABELS": names,
        "UNITS": "mm",
    }
    point = {key: value for key, value in (point | changed).items() if value is not None}
    analog = {"USED": 0, "RATE": 0.0, "GEN_SCALE": 1.0}
    blocks = 20
    point["DATA_START"] = blocks + 2
    section = group("POINT", 1) + b"".join(parameter(k, 1, v) for k, v in point.items())
    section += group("ANALOG", 2) + b"".join(parameter(k, 2, v) for k, v in analog.items())
    section = (b"\1\x50" + bytes([blocks, 84]) + section).ljust(blocks * BLOCK, b"\0")
    top = bytearray(BLOCK)
    top[:24] = struct.pack(
        "<BBHHHHHfHHf", 2, 0x50, points, 0, 1, frames, 10, -1.0, blocks + 2, 0, rate
    )
    for place, data in (header or {}).items():
        top[place : place + len(data)] = data
    return bytes(top) + section + samples.astype("<f4").tobytes()


@pytest.fixture
def c3d_bytes() -> Callable[..., bytes]:
    """What builds the bytes of a C3D file."""
    return build
