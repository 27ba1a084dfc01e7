"""A face of which markers are selected."""

from __future__ import annotations

import pytest

from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_select.faces import make_face


@pytest.fixture
def face() -> Trajectories:
    return make_face()
