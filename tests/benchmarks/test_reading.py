"""Reading a recording, beside the libraries of its form: what ours adds to theirs.

The takes have the sizes of published ones, and one is long.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from numpy.typing import NDArray

import nodegraph
from nodegraph_files import read_c3d, read_npz, write_c3d, write_npz
from nodegraph_mocap import Trajectories
from tests.benchmarks.conftest import Clock

TAKES = {  # frames, markers
    "take of 335 x 60": (335, 60),
    "580 x 51": (580, 51),
    "1,499 x 41": (1499, 41),
    "1,590 x 41": (1590, 41),
    "60,000 x 41": (60_000, 41),
}


def read_by_ezc3d(path: Path) -> NDArray[np.float64]:
    ezc3d = pytest.importorskip("ezc3d")
    return np.asarray(ezc3d.c3d(str(path))["data"]["points"][:3].transpose(2, 1, 0))


def read_by_py_c3d(path: Path) -> NDArray[np.float64]:
    c3d = pytest.importorskip("c3d")
    with path.open("rb") as stream:
        points = np.array([points for _, points, _ in c3d.Reader(stream).read_frames()])
    positions = points[..., :3].astype(np.float64)
    positions[points[..., 3] < 0] = np.nan
    return positions


def read_by_numpy(path: Path) -> NDArray[np.float64]:
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    return np.asarray(arrays["positions"])


Reader = Callable[[Path], NDArray[np.float64]]
C3D: dict[str, Reader] = {
    "nodegraph": lambda path: read_c3d(path).positions,
    "ezc3d": read_by_ezc3d,
    "py-c3d": read_by_py_c3d,
}
NPZ: dict[str, Reader] = {
    "nodegraph": lambda path: read_npz(path).positions,
    "numpy.load": read_by_numpy,
}


@cache
def take(frames: int, markers: int) -> Trajectories:
    """Return a face with noise, gaps and impulses."""
    synthetic = nodegraph.get_node("synthesize.face")(seconds=frames / 60, markers=markers)
    recording: Trajectories = synthetic.captured
    assert recording.positions.shape == (frames, markers, 3)
    return recording


@pytest.fixture
def folder() -> Iterator[Path]:
    with TemporaryDirectory() as path:
        yield Path(path)


@pytest.mark.parametrize("size", TAKES)
@pytest.mark.parametrize("name", C3D)
def test_c3d(name: str, size: str, clock: Clock, folder: Path) -> None:
    recording = take(*TAKES[size])
    write_c3d(recording, folder / "it.c3d")
    read = _timed("reading C3D, ms", name, size, clock, C3D[name], folder / "it.c3d")
    np.testing.assert_array_equal(read, recording.positions.astype(np.float32).astype(np.float64))


@pytest.mark.parametrize("size", TAKES)
@pytest.mark.parametrize("name", NPZ)
@pytest.mark.parametrize("packed", [True, False], ids=["as written here", "numpy.savez"])
def test_npz(name: str, size: str, packed: bool, clock: Clock, folder: Path) -> None:
    recording = take(*TAKES[size])
    if packed:
        write_npz(recording, folder / "it.npz")
        case = "reading NPZ as it is written here, packed, ms"
    else:
        markers = np.array(recording.markers)
        np.savez(folder / "it.npz", positions=recording.positions, markers=markers, rate=60.0)
        case = "reading NPZ of numpy.savez, ms"
    read = _timed(case, name, size, clock, NPZ[name], folder / "it.npz")
    np.testing.assert_array_equal(read, recording.positions)


def _timed(case: str, name: str, size: str, clock: Clock, read: Reader, path: Path) -> object:
    rounds = 5 if size == "60,000 x 41" else 30
    return clock(case, name, size, lambda: read(path), scale=1e3, rounds=rounds)
