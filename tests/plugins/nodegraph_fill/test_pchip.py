"""A cubic curve that never overshoots, through each marker's own samples."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.pchip import pchip
from tests.plugins.nodegraph_fill.plain_fills import check_hermite
from tests.plugins.recordings import make_gappy, quietly


@given(seed=st.integers(0, 2**32 - 1))
def test_never_leaves_the_range_of_a_gaps_ends(seed: int) -> None:
    recording = make_gappy(seed)
    filled = quietly(pchip, recording)
    gaps = Gaps.of(recording)
    inner = gaps.subset(gaps.inner)
    for marker, start, stop in zip(inner.marker, inner.start, inner.stop, strict=True):
        ends = recording.positions[[start - 1, stop], marker]
        inside = filled.positions[start:stop, marker]
        assert np.all(inside >= ends.min(axis=0) - 1e-9)
        assert np.all(inside <= ends.max(axis=0) + 1e-9)


def slope(x: list[float], y: list[float], i: int) -> float:
    """The harmonic mean of the slopes beside an inner sample, or 0 at a turning point."""
    before = (y[i] - y[i - 1]) / (x[i] - x[i - 1])
    after = (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    if before * after <= 0:
        return 0.0
    near, far = x[i] - x[i - 1], x[i + 1] - x[i]
    w1, w2 = 2 * far + near, far + 2 * near
    return (w1 + w2) / (w1 / before + w2 / after)


def test_equals_the_hermite_curve_of_harmonic_slopes() -> None:
    check_hermite(pchip, slope)
