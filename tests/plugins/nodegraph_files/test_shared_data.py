"""Recordings that nobody here made read with the counts that their source states.

Head, model and the malformed table are tried where the tests of their readers are.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import read_c3d, read_live_link, read_marker_set_yaml, write_c3d
from nodegraph_files.readers import read_recording
from tests.studies import DATA, needs_recordings

TAKES = {  # frames, markers, rate, missing samples
    "animface/jaw": (1590, 41, 60.0, 0),
    "animface/cheeks": (1499, 41, 60.0, 0),
    "facecap/take001": (335, 60, 30.0, 0),
    "vicon/shoulder": (580, 51, 100.0, 305),
}

pytestmark = [
    needs_recordings,
    pytest.mark.filterwarnings("error"),
]


@pytest.mark.parametrize("name", TAKES)
def test_a_take_reads_as_the_library_reads_it(name: str) -> None:
    import ezc3d

    path = DATA / f"{name}.c3d"
    frames, markers, rate, missing = TAKES[name]
    recording = read_recording(path=path)
    file = ezc3d.c3d(str(path))
    np.testing.assert_array_equal(
        recording.positions, file["data"]["points"][:3].transpose(2, 1, 0)
    )
    assert list(recording.markers) == file["parameters"]["POINT"]["LABELS"]["value"]
    assert recording.positions.shape == (frames, markers, 3)
    assert recording.rate == rate
    assert np.count_nonzero(~recording.present) == missing


@pytest.mark.parametrize("name", TAKES)
def test_a_take_survives_writing(name: str, tmp_path: Path) -> None:
    recording = read_c3d(DATA / f"{name}.c3d")
    write_c3d(recording, tmp_path / "again")
    again = read_c3d(tmp_path / "again")
    np.testing.assert_array_equal(again.positions, recording.positions)
    assert (again.markers, again.rate) == (recording.markers, recording.rate)


def test_the_gaps_of_the_shoulder_are_those_that_were_counted() -> None:
    missing = ~read_c3d(DATA / "vicon" / "shoulder.c3d").present
    lengths = []
    for marker in missing.T:
        changes = np.flatnonzero(np.diff(marker.astype(int), prepend=0, append=0))
        runs = changes.reshape(-1, 2)
        lengths += [stop - start for start, stop in runs if start > 0 and stop < len(marker)]
    assert round(100 * missing.mean(), 2) == 1.03
    assert (len(lengths), min(lengths), max(lengths)) == (34, 1, 71)
    assert np.count_nonzero(missing.any(axis=0)) == 13
    assert missing.sum(axis=1).max() == 3


@pytest.mark.parametrize(("name", "count", "pairs"), [("animface", 41, 17), ("facecap", 60, 26)])
def test_a_marker_set_has_each_marker_in_a_pair_or_on_the_midline(
    name: str, count: int, pairs: int
) -> None:
    markers = read_marker_set_yaml(DATA / name / "markers.yaml")
    assert (len(markers.markers), len(markers.pairs)) == (count, pairs)
    placed = [marker for pair in markers.pairs for marker in pair] + list(markers.midline)
    assert sorted(placed) == sorted(markers.markers)


@pytest.mark.parametrize("name", ["animface/jaw", "animface/cheeks", "facecap/take001"])
def test_a_marker_set_fits_its_takes(name: str) -> None:
    path = DATA / f"{name}.c3d"
    recording = read_recording(path=path, marker_set=path.with_name("markers.yaml"))
    assert recording.marker_set is not None
    assert set(recording.marker_set.markers) == set(recording.markers)
    assert read_recording(path=path).marker_set is None


def test_weights_without_dropped_frames() -> None:
    path = DATA / "livelink" / "actor_a_60fps.csv"
    read = read_live_link(path)
    assert (read.values.shape, read.rate) == ((328, 52), 60)
    assert (read.names[0], read.names[-1]) == ("EyeBlinkLeft", "TongueOut")
    whole = np.genfromtxt(path, delimiter=",", skip_header=1)
    np.testing.assert_array_equal(read.values, whole[:, 2:54])


@pytest.mark.filterwarnings("default")
def test_weights_with_three_dropped_frames() -> None:
    path = DATA / "livelink" / "actor_b_30fps.csv"
    with pytest.warns(UserWarning, match="skips 3 frames in 3 gaps") as caught:
        read = read_live_link(path)
    assert len(caught) == 1
    assert (read.values.shape, read.rate) == ((4030 + 3, 52), 30)
    lost = np.isnan(read.values).all(axis=1)
    assert lost.sum() == np.isnan(read.values).any(axis=1).sum() == 3
    whole = np.genfromtxt(path, delimiter=",", skip_header=1)
    np.testing.assert_array_equal(read.values[~lost], whole[:, 2:54])
