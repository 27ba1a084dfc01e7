"""The motion of the neighbours, and the best assignment of a frame's points as a whole."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.follow import (
    Gate,
    Links,
    Method,
    OpenTracks,
    Patience,
    Shortest,
    follow,
    live_form,
    lookahead,
)
from nodegraph_track.linking import assign

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_track.linking import Pairs

MOST_ROUNDS = 8
"""How often motion and links are found from each other; two rounds nearly always settle them."""


def _method(neighbours: int) -> Method:
    return partial(_link, neighbours=neighbours)


@node(
    "track.neighbours",
    cite=("guenter1998", "crocker_grier1996", "crouse2016"),
    adapted=(
        "from Crocker and Grier 1996: distances are to positions predicted by the neighbours' "
        "motion, after Guenter et al. 1998"
    ),
    lookahead=lookahead,
    live=live_form(_method),
)
def neighbours(
    detections: Detections,
    reference: Trajectories | None = None,
    *,
    gate: Gate = None,
    patience: Patience = 60,
    shortest: Shortest = 3,
    neighbours: Annotated[int, Field(ge=1)] = 8,
) -> Trajectories:
    """Follow points by the motion of their neighbours, assigning those of a frame as a whole.

    A track m that was at ``p[m]`` in the frame before is expected at
    ``x[m] = p[m] + median(q[n] - p[n])``, coordinate by coordinate, over the nearest tracks n
    that have a point both in that frame, ``p[n]``, and in this one, ``q[n]``. A track that gets
    no point goes on to ``x[m]``: so it is found again where the face has carried it, however
    the head moved meanwhile. This is how Guenter et al. fill gaps, with the median for the mean:
    a neighbour that is linked wrongly does not lead it away.

    Links are those of the least ``sum(d[m, j]) + gate^2 n``, ``d[m, j]`` being the squared
    distance of ``x[m]`` and point j, among pairs within the gate, and n the number of tracks
    that get no point (the cost of Crocker & Grier about the predicted positions), by shortest
    augmenting paths (Crouse). Motion and links need each other: in a first round the tracks
    that were seen in the frame before are linked where their own velocity leads, the median of
    their last three steps; then motion and links are found from each other until the links stay
    as they are, at most 8 times. A track that gets no point is looked for in the same
    way, among the points left, where its own velocity leads, if it was seen in the frame before,
    for it may move otherwise than its neighbours; and then where it would be had its last point
    been where the one before was, ``x[m] - (p1[m] - p2[m])``, for its last point ``p1[m]`` may
    be an impulse.

    A marker that is hidden while it moves otherwise than all that are near it, by more than the
    gate, is lost; `track.assignment` may find it. A track without any such neighbour goes on at
    its own velocity for a frame, and then stays where it is.

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
        How far from where it is expected a track finds a point. None: half the median distance
        from a point to the nearest one of the same frame, in 200 frames of the take.
    patience
        How many frames a track stays open without a point.
    shortest
        Tracks of fewer points are dropped as ghosts, and counted in a warning. Never more than
        the take has frames.
    neighbours
        How many neighbours' motion is looked at, fewer where there are fewer.

    Returns
    -------
    Trajectories
        The tracks; every sample is a point of that frame, and no point is used twice.
    """
    method = _method(neighbours)
    return follow(detections, reference, method, gate=gate, patience=patience, shortest=shortest)


def _link(
    tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float, neighbours: int
) -> Links:
    from nodegraph_track.motion_kernel import carried_by_neighbours

    seen = tracks.seen == frame - 1
    alone = tracks.led_by_velocity(frame, fade=0.0)
    expected = np.where(seen[:, None], alone, np.nan)
    links: Pairs | None = None
    for _ in range(MOST_ROUNDS):
        before, links = links, _both(seen, *assign(expected, points, gate))
        if before is not None and all(map(np.array_equal, before, links)):
            break
        track, point = links
        motion, most = points[point] - tracks.place[track], min(neighbours, len(track))
        expected = carried_by_neighbours(tracks.place, track, motion, most, alone)
    return Links(expected, *assign(expected, points, gate, alone, expected - tracks.jump))


def _both(seen: NDArray[np.bool_], track: NDArray[np.intp], point: NDArray[np.intp]) -> Pairs:
    """Return the links of tracks that have a point in the frame before, too."""
    chosen = seen[track]
    return track[chosen], point[chosen]
