"""An hour at 120 Hz of 100 markers, 1 GB of numbers: in how much memory it is read and filtered."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.benchmarks.hour import CHAINS, FRAMES, MARKERS, TENTH
from tests.benchmarks.tables import Tables

ROOT = Path(__file__).parents[2]
HOUR = "peak memory of an hour at 120 Hz of 100 markers (1.04 GB), GB"
C3D = "peak memory of a reader, in recordings of 43,200 frames x 100 markers"
NPZ = "peak memory of a reader, in recordings of 432,000 frames x 100 markers"


@pytest.fixture(scope="module")
def folder() -> Iterator[Path]:
    """The files, which go at once: pytest would keep gigabytes of three runs."""
    with TemporaryDirectory() as path:
        peak_of("make", path)
        yield Path(path)


@pytest.mark.parametrize("file", ["hour.c3d", "hour.npz"])
@pytest.mark.parametrize("stored", ["not stored", "stored"])
@pytest.mark.parametrize("chain", CHAINS)
def test_chain(chain: str, stored: str, file: str, folder: Path, tables: Tables) -> None:
    peak = peak_of("run", folder / file, chain, stored)
    tables.put(HOUR, chain, f"{file}, {stored}", peak / 1e9)
    assert peak < 4e9


@pytest.mark.parametrize("library", ["nodegraph", "numpy.load"])
def test_reader_of_npz(library: str, folder: Path, tables: Tables) -> None:
    peak = peak_of("read", folder / "hour.npz", library)
    tables.put(NPZ, library, "NPZ", peak / bytes_of(FRAMES))


@pytest.mark.parametrize("library", ["nodegraph", "ezc3d", "py-c3d"])
def test_reader_of_c3d(library: str, folder: Path, tables: Tables) -> None:
    if library != "nodegraph":
        pytest.importorskip({"py-c3d": "c3d"}.get(library, library))
    peak = peak_of("read", folder / "tenth.c3d", library)
    tables.put(C3D, library, "C3D", peak / bytes_of(TENTH))


def bytes_of(frames: int) -> int:
    return frames * MARKERS * 3 * 8


def peak_of(*words: str | Path) -> int:
    """Return the most memory of a process that does what the words say."""
    command = [sys.executable, "-m", "tests.benchmarks.hour", *map(str, words)]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    return int(done.stdout.split()[-1])
