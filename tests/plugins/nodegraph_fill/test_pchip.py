"""A cubic curve that never overshoots, through each marker's own samples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.pchip import pchip
from nodegraph_mocap import Trajectories


@given(seed=st.integers(0, 2**32 - 1))
def test_never_leaves_the_range_of_a_gaps_ends(
    gappy: Callable[[int], Trajectories], quietly: Callable[..., Trajectories], seed: int
) -> None:
    recording = gappy(seed)
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


@pytest.mark.parametrize("seed", range(5))
def test_equals_the_hermite_curve_of_harmonic_slopes(
    recorded: Callable[..., Trajectories], seed: int
) -> None:
    truth = np.cumsum(np.random.default_rng(seed).normal(size=(14, 1, 3)), axis=0)
    gappy = truth.copy()
    gappy[5:9] = np.nan
    filled = pchip(recorded(gappy)).positions
    known = [0, 1, 2, 3, 4, 9, 10, 11, 12, 13]
    for axis in range(3):
        y = [float(truth[frame, 0, axis]) for frame in known]
        x = [float(value) for value in known]
        first, last = slope(x, y, 4), slope(x, y, 5)
        for frame in range(5, 9):
            s = (frame - 4) / 5
            expected = (
                (1 + 2 * s) * (1 - s) ** 2 * y[4]
                + s * (1 - s) ** 2 * 5 * first
                + s * s * (3 - 2 * s) * y[5]
                + s * s * (s - 1) * 5 * last
            )
            assert filled[frame, 0, axis] == pytest.approx(expected, abs=1e-10)
