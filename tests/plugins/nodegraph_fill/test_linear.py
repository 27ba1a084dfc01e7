"""A straight line across each gap."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.linear import linear
from tests.plugins.recordings import make_gappy, quietly


@given(seed=st.integers(0, 2**32 - 1), max_gap=st.sampled_from([None, 1, 4]))
def test_equals_numpy_interp(seed: int, max_gap: int | None) -> None:
    recording = make_gappy(seed)
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
