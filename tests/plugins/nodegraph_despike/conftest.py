"""A recording without impulses."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_despike.impulses import make_wavy

Positions = NDArray[np.float64]


@pytest.fixture(scope="session")
def wavy() -> Trajectories:
    """A clean recording, 120 frames of 6 markers."""
    return make_wavy()
