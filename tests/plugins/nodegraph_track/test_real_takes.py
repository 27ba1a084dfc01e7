"""Recordings of a real face without their names, and tracked again."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph_gaps.dropout import dropout as hide
from nodegraph_mocap import Table, Trajectories
from nodegraph_score.tracking import tracking
from nodegraph_track.assignment import assignment
from nodegraph_track.nearest import nearest
from nodegraph_track.neighbours import neighbours
from nodegraph_track.points_scatter import scatter
from tests.plugins.recordings import quietly, real_take
from tests.studies import needs_recordings

Tracker = Callable[..., Trajectories]

pytestmark = needs_recordings


def score(tracker: Tracker, take: Trajectories, dropout: float, ghosts: float) -> Table:
    detections, truth = scatter(take, dropout=dropout, ghosts=ghosts)
    return quietly(tracking, quietly(tracker, detections), truth)


def wrong(tracker: Tracker, take: Trajectories, dropout: float, ghosts: float) -> float:
    actual = score(tracker, take, dropout, ghosts)
    return float(np.average(actual["wrong"], weights=actual["links"]))


@pytest.mark.parametrize("tracker", [assignment, neighbours])
@pytest.mark.parametrize("name", ["animface/jaw", "animface/cheeks"])
@pytest.mark.parametrize(("dropout", "ghosts"), [(0.02, 0.01), (0.1, 0.05)])
def test_every_link_is_right(tracker: Tracker, name: str, dropout: float, ghosts: float) -> None:
    actual = score(tracker, real_take(name), dropout, ghosts)
    assert (actual["right"] == 1.0).all()
    assert actual["switches"].sum() == 0
    assert actual["tracked"].mean() == pytest.approx(1.0 - dropout, abs=0.0005)


def test_neighbours_find_the_hidden_markers_of_a_face_that_holds_still() -> None:
    take = hide(real_take("animface/cheeks"), length=45, share=0.15, seed=0).gappy
    ours, other = (
        wrong(each, take, dropout=0.02, ghosts=0.05) for each in (neighbours, assignment)
    )
    assert 1.5 * ours < other
    assert ours < 10.0


def test_a_head_that_moves_fast_is_for_the_neighbours() -> None:
    actual = [
        wrong(value, real_take("facecap/take001"), dropout=0.05, ghosts=0.02)
        for value in (neighbours, assignment, nearest)
    ]
    assert actual[0] < 300.0
    assert 4.0 * actual[0] < actual[1] < actual[2]


@pytest.mark.parametrize("tracker", [assignment, neighbours])
def test_a_body_whose_parts_move_by_themselves_needs_prediction(tracker: Tracker) -> None:
    body = real_take("vicon/shoulder")
    assert wrong(tracker, body, dropout=0.2, ghosts=0.05) < 100.0
    assert wrong(nearest, body, dropout=0.2, ghosts=0.05) > 500.0
