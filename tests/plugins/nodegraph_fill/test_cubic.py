"""A cubic spline through each marker's own samples."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline

from nodegraph_fill.cubic import cubic
from tests.plugins.recordings import make_gappy, make_recording, quietly


@given(seed=st.integers(0, 2**32 - 1))
def test_equals_the_interpolating_b_spline(seed: int) -> None:
    recording = make_gappy(seed)
    filled = quietly(cubic, recording)
    for marker, present in enumerate(recording.present.T):
        known = np.flatnonzero(present)
        if len(known) < 2:
            continue
        degree = min(3, len(known) - 1)
        curve = make_interp_spline(known, recording.positions[known, marker], k=degree)
        inside = np.arange(known[0], known[-1] + 1)
        np.testing.assert_allclose(
            filled.positions[inside, marker], curve(inside), rtol=1e-9, atol=1e-7
        )


def test_a_marker_that_moves_as_a_cubic_is_filled_exactly() -> None:
    time = np.arange(30.0)[:, None] / 10
    truth = np.concatenate([time**3 - 2 * time, time**2, 5 - time**3], axis=1)[:, None]
    gappy = truth.copy()
    gappy[[4, 5, 6, 7, 20, 28]] = np.nan
    np.testing.assert_allclose(cubic(make_recording(gappy)).positions, truth, rtol=0, atol=1e-10)
