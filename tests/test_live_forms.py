"""Frame by frame, shipped nodes give what they give of a whole take, with other settings too."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph.node.decorator import node_of
from nodegraph.testing import check_node
from nodegraph_mocap import Trajectories


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("fill.guenter", {"max_gap": 3, "close_gap": "ramp"}),
        ("fill.lin_ouhyoung", {"max_gap": 3, "ends": "met", "use_filled": False}),
        ("fill.muscle", {"max_gap": 2}),
        ("fill.linear", {"max_gap": 3}),
        ("fill.neighbour_kalman", {"max_gap": 3}),
        ("fill.pattern", {"max_gap": 3}),
        ("fill.rigid", {"max_gap": 3, "neighbours": 4}),
        ("despike.impulse", {"mean_step": 0.3}),
        ("despike.impulse", {"calibration": 5, "order": "in_place"}),
        ("track.neighbours", {"gate": 8.0}),
        ("smooth.bspline", {"order": 6, "ends": "clamped"}),
        ("smooth.savgol", {"reach": 3}),
        ("align.procrustes", {"scale": "rms", "restore": False}),
        ("solve.weights", {"ridge": 0.5}),
    ],
)
def test_a_stream_gives_what_the_take_gives(name: str, settings: Mapping[str, object]) -> None:
    check_node(get_node(name), settings=settings)


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("fill.guenter", {"close_gap": "blend", "max_gap": 5}),
        ("fill.waters", {"ends": "met"}),
        ("fill.lin_ouhyoung", {"neighbours": "one_ring"}),
        ("fill.neighbour_kalman", {"ends": "met", "max_gap": 3}),
        ("fill.rigid", {}),
        ("smooth.savgol", {}),
        ("despike.impulse", {}),
        ("despike.impulse", {"mean_step": 0.3, "order": "redetect"}),
    ],
)
def test_what_needs_the_take_has_no_bound(name: str, settings: Mapping[str, object]) -> None:
    node = node_of(get_node(name))
    assert node is not None
    assert node.live_lookahead({**node.defaults, **settings}) is None


def test_the_end_of_a_gap_needs_nothing_that_is_filled_backward() -> None:
    random = np.random.default_rng(3)
    positions = 50 * random.normal(size=(4, 3)) + np.cumsum(random.normal(size=(12, 4, 3)), axis=0)
    positions[:4, 0] = positions[1:3, 1] = np.nan  # the second gap ends within the first
    take = Trajectories(positions=positions, markers=("a", "b", "c", "d"), rate=60.0)
    ramp = {"max_gap": 4, "close_gap": "ramp"}
    check_node(get_node("fill.muscle"), inputs={"recording": take}, settings=ramp)
