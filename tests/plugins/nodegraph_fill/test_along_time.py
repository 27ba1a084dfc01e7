"""What the fills along time share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph_fill.akima import akima
from nodegraph_fill.cubic import cubic
from nodegraph_fill.linear import linear
from nodegraph_fill.pchip import pchip
from nodegraph_mocap import Trajectories
from tests.plugins.recordings import make_recording

FILLS = (linear, pchip, cubic, akima)


@pytest.mark.parametrize("fill", FILLS, ids=lambda fill: str(fill.__name__))
def test_between_two_samples_alone_the_curve_is_straight(fill: Callable[..., Trajectories]) -> None:
    line = np.arange(6.0)[:, None, None] * np.array([1.0, -2.0, 0.5])
    gappy = line.copy()
    gappy[1:5] = np.nan
    np.testing.assert_allclose(fill(make_recording(gappy)).positions, line, rtol=0, atol=1e-12)
