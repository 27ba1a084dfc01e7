"""What the fills share that take the recording as one matrix."""

from __future__ import annotations

from weakref import ref

import numpy as np

from nodegraph.equality import same
from nodegraph_fill.bilinear import bilinear
from nodegraph_fill.gaps import Gaps
from nodegraph_fill.soft_impute import soft_impute
from nodegraph_fill.subspace_kalman import subspace_kalman
from nodegraph_fill.whole_take import Estimate, TakeMatrix, whole_take
from nodegraph_mocap import Trajectories
from tests.plugins.recordings import make_gappy, make_recording


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


def a_take() -> Trajectories:
    random = np.random.default_rng(3)
    positions = random.normal(size=(60, 2)).cumsum(axis=0) @ random.normal(size=(2, 36))
    positions = positions.reshape(60, 12, 3) + random.normal(0, 0.1, (60, 12, 3))
    for marker in range(12):
        positions[3 + marker :][:4, marker] = np.nan
    return make_recording(positions)


def test_what_other_settings_and_fills_have_made_of_a_take_changes_nothing() -> None:
    again = a_take()
    for fill in (soft_impute, bilinear, subspace_kalman):
        for ends in ("as_published", "met", "as_published"):
            assert same(fill(again, ends=ends), fill(a_take(), ends=ends))
    assert same(soft_impute(again, shrinkage=0.01), soft_impute(a_take(), shrinkage=0.01))


def test_a_take_is_estimated_once_as_long_as_it_lives() -> None:
    calls = []

    @whole_take("fill.counted", cite="none")
    def counted(recording: Trajectories, gaps: Gaps) -> Estimate:
        """Fill with zeros."""
        calls.append(ref(recording))
        return Estimate(np.zeros((*gaps.shape, 3)))

    for _ in range(2):
        take = a_take()
        for ends in ("met", "as_published", "met"):
            counted(take, ends=ends)
    assert len(calls) == 2
    assert calls[0]() is None
