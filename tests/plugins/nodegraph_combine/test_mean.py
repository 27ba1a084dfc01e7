"""The mean of several recordings."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nodegraph import Across
from nodegraph_combine.mean import mean
from nodegraph_mocap import Trajectories

Filled = Callable[[list[float]], Across[Trajectories]]


def test_is_the_mean_of_those_that_are_there(filled: Filled, truth: Trajectories) -> None:
    combined = mean(filled([1.0, np.nan, 4.0, 7.0]))
    off = combined.positions[10:20, 1] - truth.positions[10:20, 1]
    np.testing.assert_allclose(off, np.broadcast_to([4.0, 0.0, 0.0], off.shape), atol=1e-12)
