"""A cubic curve of local slopes, through each marker's own samples."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph_fill.akima import akima
from nodegraph_mocap import Trajectories


def slope(x: list[float], y: list[float], i: int) -> float:
    """Akima's mean of the chords beside a sample that has two others on each side."""
    m1, m2, m3, m4 = ((y[i + k + 1] - y[i + k]) / (x[i + k + 1] - x[i + k]) for k in range(-2, 2))
    after, before = abs(m4 - m3), abs(m2 - m1)
    return (m2 + m3) / 2 if after + before == 0 else (after * m2 + before * m3) / (after + before)


@pytest.mark.parametrize("seed", range(5))
def test_equals_the_hermite_curve_of_akimas_slopes(
    recorded: Callable[..., Trajectories], seed: int
) -> None:
    truth = np.cumsum(np.random.default_rng(seed).normal(size=(14, 1, 3)), axis=0)
    gappy = truth.copy()
    gappy[5:9] = np.nan
    filled = akima(recorded(gappy)).positions
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


def test_beside_a_straight_stretch_nothing_swings(recorded: Callable[..., Trajectories]) -> None:
    positions = np.zeros((20, 1, 3))
    positions[10:] = 5.0
    gappy = positions.copy()
    gappy[14:17] = np.nan
    np.testing.assert_allclose(akima(recorded(gappy)).positions, positions, rtol=0, atol=1e-12)
