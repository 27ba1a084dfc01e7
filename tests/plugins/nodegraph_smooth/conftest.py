"""A recording to smooth."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]


@pytest.fixture(scope="session")
def noisy() -> Trajectories:
    """Two seconds of three markers that move slowly, with noise."""
    random = np.random.default_rng(5)
    time = np.arange(121)[:, None, None] / 60.0
    speed, phase = random.uniform(0.5, 2.0, (2, 3, 3))
    moves = random.normal(0, 40, (3, 3)) + 8.0 * np.sin(2 * np.pi * speed * time + 6.0 * phase)
    return make_recording(moves + random.normal(0, 0.2, moves.shape))
