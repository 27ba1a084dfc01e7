"""What the step-wise fills share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph_fill.guenter import guenter
from nodegraph_fill.lin_ouhyoung import lin_ouhyoung
from nodegraph_fill.muscle import muscle
from nodegraph_fill.waters import waters
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_recording, quietly

STEPWISE = [guenter, lin_ouhyoung, muscle, waters]
Fill = Callable[..., Trajectories]


@pytest.mark.parametrize("fill", STEPWISE)
def test_equally_near_neighbours_are_taken_in_marker_order(fill: Fill) -> None:
    """Six neighbours at one distance, of which one has moved: it counts if it is early enough."""
    places = np.array([[0, 0, 0], [9, 0, 0], [-9, 0, 0], [0, 9, 0], [0, -9, 0], [0, 0, 9]], float)
    settings = {"neighbours": 3} if fill in (guenter, lin_ouhyoung) else {}
    chosen = {guenter: 3, lin_ouhyoung: 3, muscle: 3, waters: 1}[fill]
    for moving in range(1, 6):
        positions = np.stack([places, places])
        positions[1, moving, 2] += 1
        positions[1, 0] = np.nan
        filled = quietly(fill, make_recording(positions), **settings)
        assert (filled.positions[1, 0, 2] > 0.1) == (moving <= chosen)


def test_a_nearer_neighbour_pushes_out_the_last_of_equally_near_ones() -> None:
    places = np.array([[0, 0, 0], [9, 0, 0], [-9, 0, 0], [0, 9, 0], [0, 0, 5]], dtype=float)
    for moving, height in ((1, 1), (2, 1), (3, 0), (4, 1)):
        positions = np.stack([places, places])
        positions[1, moving, 2] += 3
        positions[1, 0] = np.nan
        assert guenter(make_recording(positions)).positions[1, 0, 2] == pytest.approx(height)


def test_filled_neighbours_come_after_measured_ones() -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [50, 0, 0], [0, 60, 0], [0, 0, 70]], dtype=float)
    positions = np.stack([places, places + np.array([0, 0, 1])])
    positions[1, 1] += [0, 0, 99]
    positions[1, 0] = np.nan
    origin = np.full((2, 5), Origin.MEASURED, dtype=np.uint8)
    origin[1, 0], origin[0, 1] = Origin.MISSING, Origin.FILLED
    recording = make_recording(positions, origin)
    assert guenter(recording).positions[1, 0, 2] == pytest.approx(1)
    assert guenter(recording, neighbours=4).positions[1, 0, 2] == pytest.approx(25.75)
    assert guenter(recording, neighbours=4, use_filled=False).positions[1, 0, 2] == pytest.approx(1)


def test_a_neighbour_must_be_there_before_and_now() -> None:
    places = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [50, 0, 0]], dtype=float)
    positions = np.stack([places, places + np.array([0, 0, 1])])
    positions[1, 3, 2] = 7
    positions[1, 1] = positions[0, 2] = positions[1, 0] = np.nan
    filled = guenter(make_recording(positions), neighbours=1, use_filled=False)
    assert filled.positions[1, 0].tolist() == [0, 0, 7]
    assert filled.positions[1, 1].tolist() == [1, 0, 7]
    assert filled.positions[0, 2].tolist() == [2, 0, -6]


def test_a_broken_chain_stays_missing_until_the_marker_returns() -> None:
    positions = np.zeros((8, 2, 3))
    positions[:, 1, 0] = 5
    positions[1:6, 0] = positions[3, 1] = np.nan
    message = "^4 samples of 2 markers left missing: no usable neighbour 4$"
    with pytest.warns(UserWarning, match=message):
        filled = muscle(make_recording(positions))
    assert filled.present[:, 0].tolist() == [True, True, True, False, False, False, True, True]


def test_an_unknown_way_to_close_a_gap_is_refused() -> None:
    with pytest.raises(ValueError, match="none, ramp or blend, got 'ramps'"):
        muscle(make_recording(np.zeros((2, 2, 3))), close_gap="ramps")


@pytest.mark.parametrize("fill", STEPWISE)
def test_two_markers_in_one_place(fill: Fill) -> None:
    positions = np.zeros((6, 5, 3))
    positions[:, 2:] = [[20, 0, 0], [0, 20, 0], [0, 0, 20]]
    positions[2:4, 0] = np.nan
    filled = quietly(fill, make_recording(positions))
    np.testing.assert_array_equal(filled.positions[2:4, 0], 0)
