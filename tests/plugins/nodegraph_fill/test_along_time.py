"""What the fills along time leave missing, and what they share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph_fill.akima import akima
from nodegraph_fill.cubic import cubic
from nodegraph_fill.linear import linear
from nodegraph_fill.pchip import pchip
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_recording

FILLS = (linear, pchip, cubic, akima)


@pytest.mark.parametrize("fill", FILLS, ids=lambda fill: str(fill.__name__))
def test_what_is_left_is_counted_by_reason(fill: Callable[..., Trajectories]) -> None:
    positions = np.ones((9, 5, 3))
    positions[:2, 0] = positions[7:, 1] = positions[:, 2] = positions[1:6, 3] = np.nan
    positions[4, 4] = np.nan
    message = (
        "^18 samples of 4 markers left missing: never measured 9, longer than max_gap 5, "
        "at the take's start 2, at the take's end 2$"
    )
    with pytest.warns(UserWarning, match=message):
        filled = fill(make_recording(positions), max_gap=4)
    assert np.argwhere(filled.origin == Origin.FILLED).tolist() == [[4, 4]]


@pytest.mark.parametrize("fill", FILLS, ids=lambda fill: str(fill.__name__))
def test_between_two_samples_alone_the_curve_is_straight(fill: Callable[..., Trajectories]) -> None:
    line = np.arange(6.0)[:, None, None] * np.array([1.0, -2.0, 0.5])
    gappy = line.copy()
    gappy[1:5] = np.nan
    np.testing.assert_allclose(fill(make_recording(gappy)).positions, line, rtol=0, atol=1e-12)
