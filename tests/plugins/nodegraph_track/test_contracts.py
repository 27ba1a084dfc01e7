"""A tracker that breaks a promise is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.nearest import nearest
from tests.promises import Family

TRACK = Family("track")


def moved(detections: Detections, recording: Trajectories) -> Trajectories:
    return replace(recording, positions=recording.positions + 1e-9)


def twice(detections: Detections, recording: Trajectories) -> Trajectories:
    positions = np.concatenate([recording.positions, recording.positions], axis=1)
    names = tuple(f"t{index:03d}" for index in range(positions.shape[1]))
    return Trajectories(positions=positions, markers=names, rate=recording.rate)


def faster(detections: Detections, recording: Trajectories) -> Trajectories:
    return replace(recording, rate=2 * recording.rate)


def by_order(detections: Detections, recording: Trajectories) -> Trajectories:
    first = np.argmin(np.abs(recording.positions[0] - detections.points[0]).sum(axis=1))
    return recording.keep([name for index, name in enumerate(recording.markers) if index != first])


def one_side(detections: Detections, recording: Trajectories) -> Trajectories:
    positions = np.where(recording.positions[..., :1] > 0, recording.positions, np.nan)
    return Trajectories(positions=positions, markers=recording.markers, rate=recording.rate)


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (moved, "samples are not points of their frame"),
        (twice, "points are used more than once"),
        (faster, "rate went in as"),
        (by_order, "in another order give other tracks"),
        (one_side, "the turned points give other tracks"),
    ],
)
def test_a_tracker_that_breaks_a_promise(
    spoil: Callable[[Detections, Trajectories], Trajectories], text: str
) -> None:
    def broken(detections: Detections) -> Trajectories:
        """Follow points, and spoil the tracks."""
        return spoil(detections, nearest(detections, shortest=1))

    TRACK.refuses(broken, text)


def test_a_tracker_with_other_ports() -> None:
    def broken(points: Detections) -> Trajectories:
        """Follow points."""
        return nearest(points)

    TRACK.refuses(broken, "name the points `detections`")
