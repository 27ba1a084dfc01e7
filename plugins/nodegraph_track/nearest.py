"""A tracker in which each track takes the nearest point: the baseline for others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph import node
from nodegraph_mocap import Trajectories
from nodegraph_track.follow import (
    Links,
    OpenTracks,
    TrackingInput,
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


@node("track.nearest", lookahead=lookahead, live=live_form(lambda: _link), shares=TrackingInput)
def nearest(given: TrackingInput) -> Trajectories:
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
    """
    return follow(given, _link)
