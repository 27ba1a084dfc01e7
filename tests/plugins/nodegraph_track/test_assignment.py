"""Motion is predicted, a frame is assigned as a whole, and one stray point leads nobody away."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_track.assignment import assignment
from nodegraph_track.nearest import nearest
from tests.plugins.nodegraph_track.points import detections, same


def crossing(frames: int = 20) -> NDArray[np.float64]:
    """Return two markers that pass each other closely in opposite directions."""
    positions = np.zeros((frames, 2, 3))
    positions[:, 0, 0] = np.arange(frames) * 2.0
    positions[:, 1, 0] = 38.5 - np.arange(frames) * 2.0
    positions[:, 1, 1] = 0.4
    return positions


def test_two_that_pass_each_other_keep_their_names() -> None:
    positions = crossing()
    assert same(assignment(detections(positions), gate=3.0), positions)
    assert not same(nearest(detections(positions), gate=3.0, shortest=1), positions)


def test_one_that_is_hidden_is_found_where_its_velocity_leads() -> None:
    positions = crossing()
    positions[6:12, 0] = np.nan
    actual = detections(positions)
    assert same(assignment(actual, gate=3.0, fade=1.0), positions)
    assert len(assignment(actual, gate=3.0, fade=1.0, patience=5).markers) == 3


@pytest.mark.parametrize("fade", [0.0, 0.5, 0.8, 1.0])
def test_the_velocity_of_one_that_is_hidden_fades(fade: float) -> None:
    positions = np.zeros((18, 1, 3))
    positions[:8, 0, 0] = np.arange(8) * 2.0
    positions[8:13] = np.nan
    expected = 14.0 + 2.0 * sum(fade**frame for frame in range(6))
    for off, tracks in ((2.4, 1), (2.6, 2)):
        positions[13:, 0, 0] = expected + off
        assert len(assignment(detections(positions), gate=2.5, fade=fade).markers) == tracks


def test_after_an_impulse_as_wide_as_the_gate_a_track_goes_on() -> None:
    positions = np.zeros((20, 1, 3))
    positions[:, 0, 0] = np.arange(20) * 0.5
    positions[10, 0] += [-1.4, 2.6, 0]  # 2.95 from where it is expected, 3.2 from the next point
    assert same(assignment(detections(positions), gate=3.0), positions)
    assert len(nearest(detections(positions), gate=3.0).markers) == 2


def test_one_that_stops_while_it_is_hidden_is_found_where_it_was() -> None:
    positions = np.zeros((30, 1, 3))
    positions[:, 0, 0] = np.minimum(np.arange(30), 8.0)
    positions[8:20] = np.nan
    assert same(assignment(detections(positions), gate=1.5), positions)


def test_a_frame_is_assigned_as_a_whole() -> None:
    # the nearest pair first would leave the first marker with a point out of its gate
    positions = np.zeros((6, 2, 3))
    positions[:, 1, 0] = 4.0
    positions[5, :, 0] = [2.1, 6.1]
    assert same(assignment(detections(positions), gate=3.0), positions)
    assert not same(nearest(detections(positions), gate=3.0, shortest=1), positions)
