"""What the fills share that take the recording as one matrix."""

from __future__ import annotations

import numpy as np

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.whole_take import TakeMatrix
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
