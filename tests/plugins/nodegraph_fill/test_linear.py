"""A straight line across each gap."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nodegraph_fill.linear import linear
from nodegraph_mocap import Origin, Trajectories


@settings(deadline=None, max_examples=100, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), max_gap=st.sampled_from([None, 1, 4]))
def test_equals_numpy_interp(
    gappy: Callable[[int], Trajectories],
    quietly: Callable[..., Trajectories],
    seed: int,
    max_gap: int | None,
) -> None:
    recording = gappy(seed)
    filled = quietly(linear, recording, max_gap=max_gap)
    time = np.arange(recording.frames)
    for marker, present in enumerate(recording.present.T):
        expected = recording.positions[:, marker].copy()
        known = np.flatnonzero(present)
        for left, right in itertools.pairwise(known):
            if max_gap is None or right - left - 1 <= max_gap:
                for axis in range(3):
                    expected[left + 1 : right, axis] = np.interp(
                        time[left + 1 : right], known, recording.positions[known, marker, axis]
                    )
        np.testing.assert_allclose(filled.positions[:, marker], expected, rtol=0, atol=1e-9)


def test_what_is_left_is_counted_by_reason(recorded: Callable[..., Trajectories]) -> None:
    positions = np.ones((9, 5, 3))
    positions[:2, 0] = positions[7:, 1] = positions[:, 2] = positions[1:6, 3] = np.nan
    positions[4, 4] = np.nan
    told = (
        "^18 samples of 4 markers left missing: never measured 9, longer than max_gap 5, "
        "at the take's start 2, at the take's end 2$"
    )
    with pytest.warns(UserWarning, match=told):
        filled = linear(recorded(positions), max_gap=4)
    assert np.argwhere(filled.origin == Origin.FILLED).tolist() == [[4, 4]]
