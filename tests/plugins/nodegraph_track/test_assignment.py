"""Motion is predicted, a frame is assigned as a whole, and one stray point leads nobody away."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.assignment import assignment
from nodegraph_track.nearest import nearest


def detections(positions: NDArray[np.float64]) -> Detections:
    present = ~np.isnan(positions[..., 0])
    offsets = np.concatenate([[0], np.cumsum(present.sum(axis=1))])
    return Detections(points=positions[present], offsets=offsets, rate=60.0)


def crossing(frames: int = 20) -> NDArray[np.float64]:
    """Return two markers that pass each other closely in opposite directions."""
    positions = np.zeros((frames, 2, 3))
    positions[:, 0, 0] = np.arange(frames) * 2.0
    positions[:, 1, 0] = 38.5 - np.arange(frames) * 2.0
    positions[:, 1, 1] = 0.4
    return positions


def same(made: Trajectories, positions: NDArray[np.float64]) -> bool:
    return np.array_equal(made.positions, positions, equal_nan=True)


def test_two_that_pass_each_other_keep_their_names() -> None:
    positions = crossing()
    assert same(assignment(detections(positions), gate=3.0), positions)
    assert not same(nearest(detections(positions), gate=3.0, shortest=1), positions)


def test_one_that_is_hidden_is_found_where_its_velocity_leads() -> None:
    positions = crossing()
    positions[6:12, 0] = np.nan
    assert same(assignment(detections(positions), gate=3.0), positions)
    assert len(assignment(detections(positions), gate=3.0, patience=5).markers) == 3


def test_an_impulse_does_not_lead_a_track_away() -> None:
    positions = crossing()[:, :1]
    positions[10, 0, 1] += 2.5
    assert same(assignment(detections(positions), gate=3.0), positions)


def test_a_frame_is_assigned_as_a_whole() -> None:
    # the nearest pair first would leave the first marker with a point out of its gate
    positions = np.zeros((6, 2, 3))
    positions[:, 1, 0] = 4.0
    positions[5, :, 0] = [2.1, 6.1]
    assert same(assignment(detections(positions), gate=3.0), positions)
    assert not same(nearest(detections(positions), gate=3.0, shortest=1), positions)
