"""The markers that move most, with their partners."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_select.variance import variance
from tests.plugins.nodegraph_select.faces import make_rigid
from tests.plugins.recordings import quietly

Reach = dict[str, float]


def moving(face: Trajectories, reach: Reach) -> Trajectories:
    """Each marker to and fro, so far."""
    swing = np.where(np.arange(20) % 2, 1.0, -1.0)[:, None] * [
        reach[value] for value in face.markers
    ]
    positions = np.zeros((20, len(face.markers), 3))
    positions[..., 1], positions[..., 0] = 0.6 * swing, 0.8 * swing
    return Trajectories(
        positions=positions, markers=face.markers, rate=60.0, marker_set=face.marker_set
    )


@pytest.fixture
def ranked(face: Trajectories) -> Trajectories:
    reach = dict.fromkeys(face.markers, 0.1)
    reach |= {"cheek_right": 9.0, "nose": 7.0, "lip_left": 5.0, "lip_right": 4.0, "chin": 3.0}
    return moving(face, reach)


@pytest.mark.parametrize(
    ("k", "chosen"),
    [
        (1, "cheek_left cheek_right"),
        (2, "cheek_left cheek_right"),
        (3, "cheek_left cheek_right nose"),
        (4, "lip_left lip_right cheek_left cheek_right nose"),
        (6, "lip_left lip_right chin cheek_left cheek_right nose"),
    ],
)
def test_from_the_largest_down_each_with_its_partner(
    ranked: Trajectories, k: int, chosen: str
) -> None:
    assert variance(ranked, k=k).chosen == tuple(chosen.split())


def test_the_history_says_what_chose_each_pair(ranked: Trajectories) -> None:
    selection = variance(ranked, k=6)
    assert selection.columns == ("markers", "variance")
    assert selection.history == pytest.approx(np.array([[2, 81.0], [3, 49.0], [5, 25.0], [6, 9.0]]))
    assert selection.frequencies is None


def test_markers_that_move_equally_come_in_the_order_of_names(face: Trajectories) -> None:
    assert variance(moving(face, dict.fromkeys(face.markers, 1.0)), k=3).chosen == (
        "brow_left", "brow_right", "cheek_left", "cheek_right"
    )  # fmt: skip


def test_what_does_not_move_comes_by_name_and_is_reported(face: Trajectories) -> None:
    for seed in range(3):
        positions = make_rigid(face, seed).positions.copy()
        positions[:, face.markers.index("nose")] += face.positions[:, 3]
        still = replace(face, positions=positions)
        with pytest.warns(UserWarning, match="only 1 of the 2 pairs chosen move; the others are"):
            selection = variance(still, k=2)
        assert selection.chosen == ("brow_left", "brow_right", "nose")
        assert selection.history is not None
        assert selection.history[1, 1] == 0.0


def test_one_frame_is_refused_and_no_marker_set_needed(face: Trajectories) -> None:
    with pytest.raises(Refusal, match="two frames"):
        variance(replace(face, positions=face.positions[:1], origin=face.origin[:1]), k=2)
    assert len(quietly(variance, replace(face, marker_set=None), k=4).chosen) == 4
