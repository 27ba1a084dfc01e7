"""What the fills share that take the recording as one matrix."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.whole_take import Estimate, TakeMatrix, fill_from
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_gappy, make_recording


def model(recording: Trajectories, gaps: Gaps) -> Estimate:
    """Every sample is at (7, 7, 7), give or take 2 mm."""
    return Estimate(np.full_like(recording.positions, 7.0), np.full(gaps.shape, 2.0))


def holed() -> Trajectories:
    positions = np.zeros((8, 3, 3))
    positions[2:4, 0] = positions[5:, 1] = positions[:, 2] = np.nan
    return make_recording(positions)


def test_gaps_are_filled_and_marked() -> None:
    recording = holed()
    with pytest.warns(UserWarning, match="^8 samples of 1 marker left missing: never measured 8$"):
        filled = fill_from(recording, None, model, ends="as_published")
    written = np.zeros((8, 3), dtype=bool)
    written[2:4, 0] = written[5:, 1] = True
    np.testing.assert_array_equal(filled.origin == Origin.FILLED, written)
    np.testing.assert_array_equal(filled.positions[written], 7.0)


def test_present_samples_keep_their_sigma() -> None:
    positions = np.zeros((3, 1, 3))
    positions[1] = np.nan
    sigma = np.array([[0.5], [np.nan], [0.25]])
    source = make_recording(positions)
    recording = Trajectories(positions=positions, markers=source.markers, rate=60.0, sigma=sigma)
    filled = fill_from(recording, None, model, ends="as_published")
    assert filled.sigma is not None
    np.testing.assert_array_equal(filled.sigma[:, 0], [0.5, np.nan, 0.25])


def test_the_mismatch_of_each_end_is_spread() -> None:
    with pytest.warns(UserWarning, match="never measured"):
        filled = fill_from(holed(), None, model, ends="met")
    np.testing.assert_array_equal(filled.positions[2:4, 0], 0.0)
    # the gap at the take's end has a mismatch at its beginning alone
    np.testing.assert_allclose(filled.positions[5:, 1, 0], [7 / 4, 14 / 4, 21 / 4])


def test_long_gaps_are_left_and_the_model_is_not_asked_for_nothing() -> None:
    def never(recording: Trajectories, gaps: Gaps) -> Estimate:
        raise AssertionError("nothing to fill")

    with pytest.warns(UserWarning, match="never measured 8, longer than max_gap 5$"):
        filled = fill_from(holed(), 1, never, ends="met")
    assert not np.any(filled.origin == Origin.FILLED)


def test_the_matrix_comes_back_as_positions() -> None:
    for seed in range(20):
        recording = make_gappy(seed)
        if not recording.present.any():
            continue
        matrix = TakeMatrix.of(recording)
        back = matrix.positions(np.where(matrix.missing, np.nan, matrix.rows))
        np.testing.assert_allclose(back, recording.positions, rtol=0, atol=1e-12)
        np.testing.assert_allclose(matrix.rows.sum(axis=0), 0.0, atol=1e-10)


def test_beside_a_gap_the_markers_that_lack_in_it_are_hidden() -> None:
    positions = np.random.default_rng(1).normal(size=(9, 4, 3))
    positions[3:6, 0] = positions[5:7, 1] = positions[2, 2] = positions[6:, 3] = np.nan
    recording = make_recording(positions)
    ends = TakeMatrix.of(recording).hidden_ends(Gaps.of(recording))
    actual = {
        (int(frame), int(marker)): np.flatnonzero(missing[::3]).tolist()
        for frame, marker, missing in zip(ends.frame, ends.marker, ends.missing, strict=True)
    }
    assert actual == {
        (2, 0): [0, 2],
        (6, 0): [0, 1, 3],
        (4, 1): [0, 1],
        (7, 1): [1, 3],
        (1, 2): [2],
        (3, 2): [0, 2],
        (5, 3): [0, 1, 3],
    }
