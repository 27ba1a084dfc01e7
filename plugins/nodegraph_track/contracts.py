"""Contracts of every tracker, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Detections, Trajectories
from nodegraph_mocap.contracts import changes

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TURN = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])
"""A turn by which coordinates only change places and signs, so that nothing is rounded."""


def takes_points_and_gives_a_recording(tried: Tried) -> Iterator[str]:
    """Take `detections`, and give a recording of as many frames and that rate first."""
    detections, recording = tried.inputs.get("detections"), next(iter(tried.outputs.values()))
    if not isinstance(detections, Detections):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name the points `detections`"
    elif not isinstance(recording, Trajectories):
        yield f"its first output is not a recording; it gives {', '.join(tried.outputs)}"
    else:
        yield from changes(detections, recording, ("frames", "rate"))


def gives_each_point_once(tried: Tried) -> Iterator[str]:
    """Give points of that frame only, bit for bit, none of them twice."""
    if any(takes_points_and_gives_a_recording(tried)):
        return
    detections, recording = tried.inputs["detections"], next(iter(tried.outputs.values()))
    there, how_many = np.unique(_points(detections), axis=0, return_counts=True)
    every = np.concatenate([there, _samples(recording)])
    distinct, index = np.unique(every, axis=0, return_inverse=True)
    used = np.bincount(index.ravel()[len(there) :], minlength=len(there))
    if len(distinct) > len(there):
        yield f"{len(distinct) - len(there)} samples are not points of their frame"
    elif np.any(used > how_many):
        yield f"{np.count_nonzero(used > how_many)} points are used more than once"


def does_not_depend_on_the_order_of_points(tried: Tried) -> Iterator[str]:
    """Give the same tracks, by the same names, for points in another order, none coinciding."""
    if any(takes_points_and_gives_a_recording(tried)) or _coincide(tried.inputs["detections"]):
        return
    detections, recording = tried.inputs["detections"], next(iter(tried.outputs.values()))
    frame, points = _points(detections)[:, 0], detections.points
    backward = np.lexsort((-np.arange(len(frame)), frame))
    again = tried.again(detections=replace(detections, points=points[backward]))
    if again is None:
        yield "declines the points in another order"
        return
    other = next(iter(again.values()))
    if recording.markers != other.markers or not np.array_equal(
        recording.positions, other.positions, equal_nan=True
    ):
        yield "the points in another order give other tracks"


def moves_with_the_points(tried: Tried) -> Iterator[str]:
    """Give, for points and references turned as a whole, the tracks turned, in whatever order."""
    if any(takes_points_and_gives_a_recording(tried)) or _coincide(tried.inputs["detections"]):
        return
    detections, recording = tried.inputs["detections"], next(iter(tried.outputs.values()))
    turned = {"detections": replace(detections, points=detections.points @ _TURN.T)} | {
        name: replace(value, positions=value.positions @ _TURN.T)
        for name, value in tried.inputs.items()
        if isinstance(value, Trajectories)
    }
    again = tried.again(**turned)
    if again is None:
        yield "declines the turned points"
        return
    back = next(iter(again.values())).positions @ _TURN
    if not np.array_equal(_sorted(recording.positions), _sorted(back), equal_nan=True):
        yield "the turned points give other tracks"


CONTRACTS = (
    takes_points_and_gives_a_recording,
    gives_each_point_once,
    does_not_depend_on_the_order_of_points,
    moves_with_the_points,
)


def _points(detections: Detections) -> NDArray[np.float64]:
    """Return (N, 4): the frame of each point, and the point."""
    frame = np.repeat(np.arange(detections.frames), np.diff(detections.offsets))
    return np.column_stack([frame, detections.points])


def _samples(recording: Trajectories) -> NDArray[np.float64]:
    """Return (N, 4): the frame of each present sample, and the sample."""
    frame, _ = np.nonzero(recording.present)
    return np.column_stack([frame, recording.positions[recording.present]])


def _coincide(detections: Detections) -> bool:
    return len(np.unique(_points(detections), axis=0)) < len(detections.points)


def _sorted(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (M, 3 T): the tracks in an order that does not depend on their names."""
    rows = positions.transpose(1, 0, 2).reshape(positions.shape[1], -1)
    return np.asarray(rows[np.lexsort(np.nan_to_num(rows, nan=np.inf).T)])
