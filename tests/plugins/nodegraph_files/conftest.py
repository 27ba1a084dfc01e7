"""C3D files made byte by byte, so that a file can also be wrong; and small recordings."""

from __future__ import annotations

import struct
import tracemalloc
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories

BLOCK = 512
SECTION_BLOCKS = 20
DEC, MIPS = 85, 86

Write = Callable[..., Path]
Build = Callable[..., Path]


@dataclass(frozen=True)
class Machine:
    """Writes numbers as one kind of processor does."""

    code: int

    @property
    def order(self) -> str:
        return ">" if self.code == MIPS else "<"

    def words(self, *values: int) -> bytes:
        return struct.pack(f"{self.order}{len(values)}H", *values)

    def floats(self, values: NDArray[np.float32] | float) -> bytes:
        array = np.atleast_1d(np.asarray(values, dtype="<f4"))
        if self.code == DEC:
            return (array * 4).astype("<f4").view("<u2").reshape(-1, 2)[:, ::-1].tobytes()
        return array.astype(f"{self.order}f4").tobytes()

    def group(self, name: str, number: int) -> bytes:
        text = name.encode()
        return bytes([len(text), 256 - number]) + text + self.words(3) + b"\0"

    def parameter(self, name: str, number: int, value: object) -> bytes:
        kind, shape, data = self.encoded(value)
        body = struct.pack("<bB", kind, len(shape)) + bytes(shape) + data + b"\0"
        text = name.encode()
        return bytes([len(text), number]) + text + self.words(len(body) + 2) + body

    def encoded(self, value: Any) -> tuple[int, list[int], bytes]:
        if isinstance(value, list):
            raw = [text if isinstance(text, bytes) else text.encode() for text in value]
            width = max((len(text) for text in raw), default=0)
            return -1, [width, len(raw)], b"".join(text.ljust(width) for text in raw)
        if isinstance(value, str):
            return -1, [len(value)], value.encode()
        if isinstance(value, tuple):
            return 2, [len(value)], self.words(*value)
        if isinstance(value, float):
            return 4, [], self.floats(value)
        return 2, [], self.words(value)


def build(
    samples: NDArray[np.generic],
    labels: list[object] | None = None,
    *,
    rate: float = 60.0,
    scale: float = -1.0,
    processor: int = 84,
    analog: int = 0,
    header: Mapping[int, bytes] | None = None,
    trial: tuple[int, int] | None = None,
    **changed: object,
) -> bytes:
    """Return a C3D file: (T, M, 4) samples x, y, z, residual.

    A positive `scale` stores the samples as integers. `analog` values, all 7, follow the points of
    every frame. `header` replaces bytes of the header by their place; `changed` sets POINT
    parameters, or leaves them out (None).
    """
    machine = Machine(processor)
    frames, points = samples.shape[:2]
    names = [f"m{index}" for index in range(points)] if labels is None else labels
    point: dict[str, Any] = {
        "USED": points,
        "SCALE": scale,
        "RATE": rate,
        "DATA_START": SECTION_BLOCKS + 2,
        "FRAMES": min(frames, 0xFFFF),
        "LABELS": names,
        "UNITS": "mm",
    } | changed
    groups = {
        "POINT": {key: value for key, value in point.items() if value is not None},
        "ANALOG": {"USED": analog, "RATE": rate if analog else 0.0, "GEN_SCALE": 1.0},
        "TRIAL": {}
        if trial is None
        else {
            "ACTUAL_START_FIELD": (trial[0] % 65536, trial[0] // 65536),
            "ACTUAL_END_FIELD": (trial[1] % 65536, trial[1] // 65536),
        },
    }
    section = bytes([1, 0x50, SECTION_BLOCKS, processor])
    for number, (group, entries) in enumerate(groups.items(), start=1):
        section += machine.group(group, number)
        section += b"".join(machine.parameter(key, number, value) for key, value in entries.items())
    top = bytearray(BLOCK)
    top[:12] = b"\2\x50" + machine.words(points, analog, 1, min(frames, 0xFFFF), 10)
    top[12:16] = machine.floats(scale)
    top[16:20] = machine.words(SECTION_BLOCKS + 2, 1 if analog else 0)
    top[20:24] = machine.floats(rate)
    for place, data in (header or {}).items():
        top[place : place + len(data)] = data
    flat = np.full((frames, 4 * points + analog), 7.0)
    flat[:, : 4 * points] = samples.reshape(frames, 4 * points)
    data = machine.floats(flat) if scale < 0 else flat.astype(f"{machine.order}i2").tobytes()
    return bytes(top) + section.ljust(SECTION_BLOCKS * BLOCK, b"\0") + data


@pytest.fixture
def build_c3d(tmp_path: Path) -> Build:
    """What writes a C3D file, see `build`, and returns its path."""

    def written(*arguments: Any, cut: int | None = None, **settings: Any) -> Path:
        path = tmp_path / "built.c3d"
        path.write_bytes(build(*arguments, **settings)[:cut])
        return path

    return written


@pytest.fixture
def peak_memory() -> Iterator[Callable[[], int]]:
    """What tells how many bytes the test has had in use at once so far."""
    tracemalloc.start()
    yield lambda: tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()


@pytest.fixture
def samples() -> NDArray[np.float64]:
    """(20, 3, 4), positions that 32 bits hold exactly, none missing."""
    result = np.zeros((20, 3, 4))
    result[..., :3] = np.random.default_rng(0).integers(-8000, 8000, size=(20, 3, 3)) / 8
    return result


def a_recording() -> Trajectories:
    """A recording in which two samples are missing."""
    positions = np.random.default_rng(1).normal(size=(6, 3, 3)) * 100
    positions[2, 1] = positions[5, 0] = np.nan
    return Trajectories(positions=positions, markers=("a", "b c", "é"), rate=59.94)


@pytest.fixture
def gappy() -> Trajectories:
    """The same, as a fixture."""
    return a_recording()


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """What writes a text into a file, whose path it returns."""

    def write_text(text: str, name: str = "take.csv") -> Path:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write_text
