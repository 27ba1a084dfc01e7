"""Constant velocity, and the best assignment of a frame's points as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import node
from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.follow import Gate, Links, OpenTracks, Patience, Shortest, follow
from nodegraph_track.linking import assign

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@node("track.assignment", cite=("crocker_grier1996", "crouse2016"))
def assignment(
    detections: Detections, *, gate: Gate = None, patience: Patience = 30, shortest: Shortest = 3
) -> Trajectories:
    """Follow points by their velocity, assigning those of a frame as a whole.

    A track m whose last point is ``p[m]``, at frame s, is expected at frame t at
    ``x[m] = p[m] + (t - s) v[m]``, where the velocity ``v[m]`` is the median, coordinate by
    coordinate, of the steps per frame between its last four points, steps that it does not have
    yet being 0: one impulse, or one ghost taken by mistake, does not lead it away. With the
    squared distance ``d[m, j]`` of ``x[m]`` and point j of the frame, the links are those that
    minimize ``sum(d[m, j]) + gate^2 n`` among pairs within the gate, n being the number of
    tracks that get no point (the cost of Crocker & Grier about the predicted positions), by
    `scipy.optimize.linear_sum_assignment` (Crouse).

    A point that no track takes opens one. A track without a point stays open, going on at its
    velocity; but one that has fewer than `shortest` points yet ends at once. Tracks are named
    t000, t001, ... in the order of their first points, those of one frame by x, then y, then z.
    What a track has no point for is missing. Nothing depends on the order of the points within
    a frame, unless points coincide.

    Looks ahead 0 frames to link a frame's points, and to the take's end to drop short tracks
    (and for a `gate` made from the data).

    Parameters
    ----------
    detections
        Unlabelled points.
    gate
        How far from where it is expected a track finds a point. None: half the median distance
        from a point to the nearest one of the same frame, in 200 frames of the take.
    patience
        How many frames a track stays open without a point.
    shortest
        Tracks of fewer points are dropped as ghosts, and counted in a warning. Never more than
        the take has frames.

    Returns
    -------
    Trajectories
        The tracks; every sample is a point of that frame, and no point is used twice.
    """
    return follow(detections, _link, gate=gate, patience=patience, shortest=shortest)


def _link(tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float) -> Links:
    expected = tracks.place + tracks.velocity
    return Links(expected, *assign(expected, points, gate))
