"""A take of a body."""

from __future__ import annotations

import pytest

from nodegraph_mocap import Trajectories
from tests.plugins.recordings import real_take
from tests.studies import DATA


@pytest.fixture
def shoulder() -> Trajectories:
    """Read a take of a body."""
    if not DATA.exists():
        pytest.skip("the recordings are not part of the package")
    return real_take("vicon/shoulder")
