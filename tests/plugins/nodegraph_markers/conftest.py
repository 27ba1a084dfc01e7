"""A take of a body."""

from __future__ import annotations

import pytest

from nodegraph_files import read_c3d
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_markers.takes import quiet
from tests.studies import DATA


@pytest.fixture
def shoulder() -> Trajectories:
    """Read a take of a body."""
    if not DATA.exists():
        pytest.skip("the recordings are not part of the package")
    with quiet():
        return read_c3d(DATA / "vicon" / "shoulder.c3d")
