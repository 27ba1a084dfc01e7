"""Samples that are nearer to another marker's place."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_score.steps import misplaced


@given(seed=st.integers(0, 999), far=st.sampled_from([0.0, 2000.0]))
def test_it_is_the_nearest_of_all_places(seed: int, far: float) -> None:
    rng = np.random.default_rng(seed)
    truth = rng.normal(0.0, 10.0, (6, 5, 3)) + far
    positions = truth + rng.normal(0.0, 6.0, truth.shape)
    truth[rng.random((6, 5)) < 0.15] = np.nan
    positions[rng.random((6, 5)) < 0.15] = np.nan
    expected = np.zeros((6, 5), dtype=bool)
    for frame in range(6):
        for marker in range(5):
            apart = [math.dist(positions[frame, marker], place) for place in truth[frame]]
            own = apart[marker]
            if not math.isnan(own):
                expected[frame, marker] = (
                    min(value for value in apart if not math.isnan(value)) < own
                )
    np.testing.assert_array_equal(misplaced(positions, truth), expected)
