"""C3D files between programs: ours in their readers, theirs in ours.

The others are ezc3d and c3d (py-c3d), which have no code in common with this reader and writer, nor
with each other.
"""

from __future__ import annotations

import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_files import read_c3d, write_c3d
from nodegraph_mocap import Trajectories
from nodegraph_mocap.specimens import recordings
from tests.plugins.nodegraph_files.conftest import Build

Samples = NDArray[np.float64]

# py-c3d tells that a file has no analog channels.
pytestmark = pytest.mark.filterwarnings("ignore::UserWarning:c3d")


@dataclass(frozen=True)
class Found:
    """What another program finds in a file; missing samples are NaN."""

    positions: Samples
    labels: tuple[str, ...]
    rate: float


def by_ezc3d(path: Path) -> Found:
    import ezc3d

    file = ezc3d.c3d(str(path))
    positions = file["data"]["points"][:3].transpose(2, 1, 0).copy()
    positions[file["data"]["meta_points"]["residuals"][0].T < 0] = np.nan
    point = file["parameters"]["POINT"]
    lists = ["LABELS", *(f"LABELS{number}" for number in range(2, 99))]
    labels = [label for name in lists if name in point for label in point[name]["value"]]
    return Found(positions, tuple(labels), float(point["RATE"]["value"][0]))


def by_py_c3d(path: Path) -> Found:
    import c3d

    with path.open("rb") as stream:
        reader = c3d.Reader(stream)
        # numbers that are NaN would be made missing, as they are here anyway
        frames = reader.read_frames(check_nan=False)
        points = np.array([points for _, points, _ in frames], dtype=float)
        lists = ["POINT:LABELS", *(f"POINT:LABELS{number}" for number in range(2, 99))]
        result = [parameter for name in lists if (parameter := reader.get(name)) is not None]
        labels = tuple(
            label.rstrip(" ") for parameter in result for label in parameter.string_array
        )
        rate = float(reader.point_rate)
    positions = points[..., :3]
    positions[points[..., 3] < 0] = np.nan
    return Found(positions, labels, rate)


READERS = {"ezc3d": by_ezc3d, "py-c3d": by_py_c3d}


def in_32_bits(positions: Samples) -> Samples:
    return positions.astype(np.float32).astype(np.float64)


def moving(frames: int, markers: int, names: list[str] | None = None) -> Trajectories:
    """Return a recording in which every number differs from its neighbours; some are missing."""
    numbers = np.arange(3.0 * frames * markers) % 99_991 / 8 - 5000.0625
    positions = numbers.reshape(frames, markers, 3)
    positions.reshape(-1, 3)[3::11] = np.nan
    labels = names or [f"marker{number}" for number in range(markers)]
    return Trajectories(positions=positions, markers=tuple(labels), rate=60.0)


def assert_read_alike(recording: Trajectories, path: Path, readers: list[str]) -> None:
    """Write a recording; it comes back to 32 bits, from us and from the others."""
    write_c3d(recording, path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # header and parameters agree
        ours = read_c3d(path)
    wanted = in_32_bits(recording.positions)
    np.testing.assert_array_equal(ours.positions, wanted)
    assert ours.markers == recording.markers
    assert ours.rate == float(str(np.float32(recording.rate)))
    for name in readers:
        file = READERS[name](path)
        np.testing.assert_array_equal(file.positions, wanted, err_msg=name)
        assert file.labels == recording.markers
        # ezc3d hands on nine digits
        assert file.rate == pytest.approx(recording.rate, rel=1e-7)


@pytest.mark.parametrize("name", recordings())
def test_a_specimen_is_read_alike_everywhere(name: str, tmp_path: Path) -> None:
    assert_read_alike(recordings()[name], tmp_path / "it.c3d", list(READERS))


ODD = {
    "one frame": moving(1, 3),
    "one frame of one marker": moving(1, 1),
    "a row of labels that is full": moving(2, 255),
    "one label in a second row": moving(2, 256),
    "300 markers": moving(20, 300),
    "700 markers": moving(5, 700),
    "the longest labels": moving(3, 2, ["a" * 127, "é" * 63]),
    "many long labels": moving(2, 300, [f"{number:0120}" for number in range(300)]),
    "labels of other scripts": moving(3, 4, ["ÄÖß", "鼻", "щека левая", "😀"]),
}


@pytest.mark.parametrize("name", ODD)
def test_an_odd_recording_is_read_alike_everywhere(name: str, tmp_path: Path) -> None:
    assert_read_alike(ODD[name], tmp_path / "it.c3d", list(READERS))


@pytest.mark.parametrize("frames", [32_767, 32_768, 65_534, 65_535, 65_536, 70_001])
def test_a_long_take_is_read_alike_everywhere(frames: int, tmp_path: Path) -> None:
    # Around 2^15 and 2^16 the counters of 16 bits end. py-c3d takes a second for so many frames.
    readers = ["ezc3d"] if frames in (32_767, 65_534, 65_536) else list(READERS)
    assert_read_alike(moving(frames, 1), tmp_path / "it.c3d", readers)


@pytest.mark.parametrize("rate", [0.5, 23.976, 29.97, 59.94, 59.94005994, 119.88, 240.0, 10_000.0])
def test_a_rate_is_read_alike_everywhere(rate: float, tmp_path: Path) -> None:
    still = moving(3, 2)
    recording = Trajectories(positions=still.positions, markers=still.markers, rate=rate)
    assert_read_alike(recording, tmp_path / "it.c3d", list(READERS))


@st.composite
def any_recording(draw: st.DrawFn) -> Trajectories:
    letters = st.characters(exclude_categories=["C", "Z"], exclude_characters=":")
    names = draw(
        st.lists(st.text(letters, min_size=1, max_size=30), min_size=1, max_size=5, unique=True)
    )
    shape = (draw(st.integers(1, 6)), len(names))
    numbers = st.floats(-1e6, 1e6, width=32).filter(lambda number: abs(number) > 1e-30)
    positions = draw(arrays.arrays(np.float64, (*shape, 3), elements=numbers))
    positions[draw(arrays.arrays(np.bool_, shape))] = np.nan
    rate = draw(st.floats(0.125, 1e5, width=32))
    return Trajectories(positions=positions, markers=tuple(names), rate=rate)


@given(any_recording())
def test_any_recording_is_read_alike_everywhere(recording: Trajectories) -> None:
    with tempfile.TemporaryDirectory() as folder:
        assert_read_alike(recording, Path(folder) / "it.c3d", list(READERS))


def written_by_py_c3d(path: Path, samples: Samples, *, scale: float, unit: str = "mm  ") -> None:
    """Write (T, M, 4) samples: x, y, z, residual."""
    import c3d

    writer = c3d.Writer(point_rate=50.0, point_scale=scale, point_units=unit)
    frames, markers = samples.shape[:2]
    writer.set_point_labels([f"m{number}" for number in range(markers)])
    writer.set_analog_labels([""])
    cameras = np.ones((frames, markers, 1))
    nothing = np.empty((0, 0))
    writer.add_frames([(frame, nothing) for frame in np.concatenate([samples, cameras], axis=2)])
    with path.open("wb") as stream:
        writer.write(stream)


@pytest.mark.parametrize("scale", [-1.0, 0.0625, 0.1], ids=["floats", "integers", "rounded"])
def test_what_py_c3d_writes_is_read_alike_everywhere(
    samples: Samples, tmp_path: Path, scale: float
) -> None:
    samples[4, 1, 3] = samples[0, 0, 3] = -1
    written_by_py_c3d(tmp_path / "it.c3d", samples, scale=scale)
    ours = read_c3d(tmp_path / "it.c3d")
    assert (ours.markers, ours.rate) == (("m0", "m1", "m2"), 50.0)
    np.testing.assert_array_equal(ours.present, samples[..., 3] >= 0)
    whole = np.where(ours.present[..., None], samples[..., :3], np.nan)
    np.testing.assert_allclose(ours.positions, whole, atol=0 if scale != 0.1 else 0.1)
    for read in READERS.values():
        np.testing.assert_allclose(ours.positions, read(tmp_path / "it.c3d").positions, rtol=1e-6)


@pytest.mark.parametrize(("unit", "factor"), [("m   ", 1000.0), ("cm  ", 10.0), ("in  ", 25.4)])
def test_what_py_c3d_writes_in_other_units_becomes_millimetres(
    samples: Samples, tmp_path: Path, unit: str, factor: float
) -> None:
    written_by_py_c3d(tmp_path / "it.c3d", samples, scale=-1.0, unit=unit)
    np.testing.assert_array_equal(
        read_c3d(tmp_path / "it.c3d").positions, samples[..., :3] * factor
    )


@pytest.mark.parametrize("markers", [1, 3, 300])
@pytest.mark.parametrize(("unit", "factor"), [("mm", 1.0), ("m", 1000.0)])
def test_what_ezc3d_writes_is_read_alike(
    tmp_path: Path, markers: int, unit: str, factor: float
) -> None:
    import ezc3d

    recording = moving(12, markers)
    file = ezc3d.c3d()
    point = file["parameters"]["POINT"]
    point["RATE"]["value"] = np.array([59.94])
    point["UNITS"]["value"] = [unit]
    point["LABELS"]["value"] = list(recording.markers)
    positions = np.nan_to_num(recording.positions, nan=1.0)
    file["data"]["points"] = np.ascontiguousarray(positions.transpose(2, 1, 0))
    missing = ~recording.present.T[None]
    file["data"]["meta_points"] = {"residuals": -missing.astype(float)}
    file.write(str(tmp_path / "it.c3d"))
    ours = read_c3d(tmp_path / "it.c3d")
    np.testing.assert_array_equal(ours.positions, in_32_bits(recording.positions) * factor)
    assert (ours.markers, ours.rate) == (recording.markers, 59.94)


@pytest.mark.parametrize("processor", [84, 85, 86], ids=["Intel", "DEC", "MIPS"])
@pytest.mark.parametrize("scale", [-1.0, 0.125], ids=["floats", "integers"])
def test_every_processor_is_read_as_py_c3d_reads_it(
    build_c3d: Build, samples: Samples, processor: int, scale: float
) -> None:
    samples[4, 1, 3] = -1
    stored = samples if scale < 0 else samples / np.array([scale, scale, scale, 1])
    # py-c3d takes a DEC rate of 0, which is what a file without analog channels has, for another
    path = build_c3d(stored, processor=processor, scale=scale, analog=5)
    theirs = by_py_c3d(path)
    ours = read_c3d(path)
    np.testing.assert_array_equal(ours.positions, theirs.positions)
    assert (ours.markers, ours.rate) == (theirs.labels, theirs.rate)
