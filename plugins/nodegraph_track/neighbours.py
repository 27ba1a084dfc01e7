"""The motion of the neighbours, and the best assignment of a frame's points as a whole."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

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
    from numpy.typing import NDArray

MOST_ROUNDS = 8
"""How often motion and links are found from each other; two rounds nearly always settle them."""


class _Method:
    """Keeps the neighbours of the frame before, by which those of the next one are found sooner."""

    def __init__(self, neighbours: int) -> None:
        self._neighbours = neighbours
        self._near = np.empty((0, 0), dtype=np.intp)

    def __call__(
        self, tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float
    ) -> Links:
        from nodegraph_track import linking_kernel

        if len(self._near) != len(tracks.name):
            own = np.arange(len(tracks.name))
            self._near = np.repeat(own[:, None], min(self._neighbours, len(own)), axis=1)
        rounds, near = MOST_ROUNDS, self._near
        return Links(
            *linking_kernel.assigned_by_neighbours(tracks, points, frame, gate, rounds, near)
        )


@node(
    "track.neighbours",
    cite=("guenter1998", "crocker_grier1996", "crouse2016"),
    adapted=(
        "from Crocker and Grier 1996: distances are to positions predicted by the neighbours' "
        "motion, after Guenter et al. 1998"
    ),
    lookahead=lookahead,
    live=live_form(_Method),
    shares=TrackingInput,
)
def neighbours(
    given: TrackingInput,
    *,
    neighbours: Annotated[int, Field(ge=1)] = 8,
) -> Trajectories:
    """Follow points by the motion of their neighbours, assigning those of a frame as a whole.

    A track m that was at ``p[m]`` in the frame before is expected at
    ``x[m] = p[m] + median(q[n] - p[n])``, coordinate by coordinate, over the nearest tracks n
    that have a point both in that frame, ``p[n]``, and in this one, ``q[n]``. A track that gets
    no point continues to ``x[m]``: so it is found again where the face has carried it, however
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
    gate, is lost; `track.assignment` may find it. A track without any such neighbour continues at
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
    neighbours
        How many neighbours' motion is looked at, fewer where there are fewer.
    """
    method = _Method(neighbours)
    return follow(given, method)
