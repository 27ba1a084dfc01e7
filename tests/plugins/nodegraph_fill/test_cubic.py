"""A cubic spline through each marker's own samples."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import make_interp_spline

from nodegraph_fill.cubic import cubic
from tests.plugins.recordings import make_gappy, quietly


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
