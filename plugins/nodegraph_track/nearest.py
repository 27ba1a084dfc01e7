"""A tracker in which each track takes the nearest point: the baseline for others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import node
from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.follow import (
    Gate,
    Links,
    OpenTracks,
    Patience,
    Shortest,
    follow,
    live_form,
    lookahead,
)

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def _link(tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float) -> Links:
    from nodegraph_track import linking_kernel

    return Links(tracks.place, linking_kernel.nearest_first(tracks.place, points, gate))


@node("track.nearest", lookahead=lookahead, live=live_form(lambda: _link))
def nearest(
    detections: Detections,
    reference: Trajectories | None = None,
    *,
    gate: Gate = None,
    patience: Patience = 60,
    shortest: Shortest = 3,
) -> Trajectories:
    """Follow points by giving each track the nearest one to its last position.

    In each frame the pair of track and point that is nearest is linked first, then the nearest
    of those left, and so on within the gate. No motion is predicted.

    A point that no track takes opens one. A track without a point stays open; but one that has
    fewer than `shortest` points yet ends at once. Tracks are named t000, t001, ... in the order
    of their first points, those of one frame by x, then y, then z. What a track has no point
    for is missing. Nothing depends on the order of the points within a frame, unless points
    coincide.

    Looks ahead 0 frames to link a frame's points, ``shortest - 1`` frames to drop short tracks,
    and to the take's end for a `gate` made from the data. Frame by frame, it needs a reference.

    Parameters
    ----------
    detections
        Unlabelled points.
    reference
        A recording whose markers are to be followed, from where they are in its first frame that
        has all of them: `patience` and `shortest` then play no part, and points of no marker are
        left out, counted in a warning. None: tracks are opened by points.
    gate
        How far from its last position a track finds a point. None: half the median distance
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
    return follow(detections, reference, _link, gate=gate, patience=patience, shortest=shortest)
