from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_mocap import MarkerSet, Origin, Trajectories, check_markers
from nodegraph_mocap.specimens import recordings

NAN = float("nan")


def recording_of(**changed: object) -> Trajectories:
    positions = np.arange(24.0).reshape(4, 2, 3)
    positions[1, 0] = NAN
    given: dict[str, Any] = {"positions": positions, "markers": ("a", "b"), "rate": 60}
    return Trajectories(**given | changed)


def test_origin_is_made_from_what_is_missing() -> None:
    recording = recording_of()
    assert recording.origin.dtype == np.uint8
    assert recording.origin.tolist() == [[1, 1], [0, 1], [1, 1], [1, 1]]
    np.testing.assert_array_equal(recording.present, ~np.isnan(recording.positions[..., 0]))
    assert recording.frames == 4


def test_a_part_of_the_callers_array_is_copied() -> None:
    mine = np.ones((4, 3, 3))
    recording = recording_of(positions=mine[:, :2])
    mine[0, 0] = 7
    assert (recording.positions == 1).all()


def test_a_missing_sample_has_no_sigma() -> None:
    positions = np.ones((4, 2, 3))
    positions[1, 0] = np.nan
    given = np.full((4, 2), 0.5)
    recording = recording_of(positions=positions, sigma=given)
    assert recording.sigma is not None
    np.testing.assert_array_equal(np.isnan(recording.sigma), ~recording.present)
    assert not np.isnan(given).any()


@given(arrays.arrays(np.float64, (3, 2, 3), elements=st.sampled_from([0.0, 1.0, NAN, np.inf])))
def test_exactly_whole_samples_are_accepted(positions: NDArray[np.generic]) -> None:
    finite = np.isfinite(positions).all(axis=2)
    whole = finite | np.isnan(positions).all(axis=2)
    if whole.all():
        np.testing.assert_array_equal(recording_of(positions=positions).present, finite)
    else:
        with pytest.raises(ValueError, match=f"{np.count_nonzero(~whole)} such samples"):
            recording_of(positions=positions)


def test_written_samples_get_their_origin_and_others_keep_theirs() -> None:
    recording = recording_of(sigma=np.zeros((4, 2)))
    positions = recording.positions.copy()
    positions[1, 0] = 5
    positions[3, 1] = NAN
    changed = np.zeros((4, 2), dtype=np.bool_)
    changed[1, 0] = changed[3, 1] = True
    filled = recording.with_samples(positions, changed=changed, origin=Origin.FILLED)
    assert filled.origin.tolist() == [[1, 1], [2, 1], [1, 1], [1, 0]]
    assert filled.positions[1, 0].tolist() == [5, 5, 5]
    assert filled.sigma is not None
    assert np.isnan(filled.sigma).tolist() == changed.tolist()
    assert recording.origin[1, 0] == Origin.MISSING
    known = recording.with_samples(
        positions, changed=changed, origin=Origin.REPAIRED, sigma=np.ones((4, 2))
    )
    assert known.sigma is not None
    assert np.nansum(known.sigma) == 7


def test_kept_markers_come_with_all_that_is_theirs() -> None:
    marker_set = MarkerSet(markers=("a", "b"), pairs=(("a", "b"),), stable=("b",))
    recording = recording_of(marker_set=marker_set, sigma=np.arange(8.0).reshape(4, 2))
    kept = recording.keep(["b"])
    np.testing.assert_array_equal(kept.positions[:, 0], recording.positions[:, 1])
    assert kept.origin.tolist() == [[1]] * 4
    assert kept.sigma is not None
    assert kept.sigma.ravel().tolist() == [1, 3, 5, 7]
    assert kept.marker_set == MarkerSet(markers=("b",), stable=("b",))
    assert recording.keep(("b", "a")).keep(("a", "b")).origin.tolist() == recording.origin.tolist()


def test_some_frames_come_with_all_that_is_theirs() -> None:
    recording = recordings()["filled, repaired and with sigma"]
    part = recording[10:14]
    assert (part.markers, part.rate, part.marker_set) == (
        recording.markers,
        recording.rate,
        recording.marker_set,
    )
    np.testing.assert_array_equal(part.positions, recording.positions[10:14])
    np.testing.assert_array_equal(part.origin, recording.origin[10:14])
    assert part.sigma is not None
    assert recording.sigma is not None
    np.testing.assert_array_equal(part.sigma, recording.sigma[10:14])


def test_positions_of_markers_are_nan_for_those_that_lack() -> None:
    recording = recordings()["complete"]
    positions = recording.positions_of(("nose", "elsewhere", "brow_left"))
    np.testing.assert_array_equal(positions[:, [0, 2]], recording.positions[:, [6, 0]])
    assert np.isnan(positions[:, 1]).all()
    assert recording.positions_of(()).shape == (recording.frames, 0, 3)


def test_keeping_what_is_not_there_is_refused_with_what_is() -> None:
    with pytest.raises(ValueError, match="the recording has no marker 'x'; 'y'; it has a, b"):
        recording_of().keep(["x", "a", "y"])


FACE = recordings()["complete"]


def test_each_unknown_name_is_listed_with_the_nearest_whatever_its_case() -> None:
    near = FACE.markers[0]
    message = rf"the neutral .*'{near.upper()}' \(did you mean '{near}'\?\); 'q'; it has "
    with pytest.raises(ValueError, match=message):
        check_markers(FACE, [near.upper(), "q"], what="the neutral")


def test_each_duplicate_is_listed_once() -> None:
    brow, cheek, lip, *_ = FACE.markers
    with pytest.raises(ValueError, match=f"the recording: duplicate markers {brow}, {lip}$"):
        check_markers(FACE, [brow, cheek, lip, lip, brow, brow])
