"""Constant velocity, and the best assignment of a frame's points as a whole."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_mocap import Trajectories
from nodegraph_track.follow import (
    LinkMethod,
    Links,
    OpenTracks,
    TrackingInput,
    follow,
    live_form,
    lookahead,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


def _method(fade: float) -> LinkMethod:
    return partial(_link, fade=fade)


@node(
    "track.assignment",
    cite=("crocker_grier1996", "crouse2016", "gardner_mckenzie1985"),
    adapted=(
        "from Crocker and Grier 1996: distances are to positions predicted by a damped velocity"
    ),
    lookahead=lookahead,
    live=live_form(_method),
    shares=TrackingInput,
)
def assignment(
    given: TrackingInput,
    *,
    fade: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8,
) -> Trajectories:
    """Follow points by their velocity, assigning those of a frame as a whole.

    A track m that was at ``p[m]`` in the frame before is expected at ``x[m] = p[m] + v[m]``,
    where the velocity ``v[m]`` is the median, coordinate by coordinate, of the steps per frame
    between its last four points, steps that it does not have yet being 0: one impulse, or one
    ghost taken by mistake, does not lead it away. A track that gets no point continues to
    ``x[m]``, and its velocity is multiplied by `fade` in each further frame (the damped trend
    of Gardner & McKenzie): a face turns back sooner than a long occlusion ends.

    With the squared distance ``d[m, j]`` of ``x[m]`` and point j of the frame, the links are
    those that minimize ``sum(d[m, j]) + gate^2 n`` among pairs within the gate, n being the
    number of tracks that get no point (the cost of Crocker & Grier about the predicted
    positions), by shortest augmenting paths (Crouse). A track that gets none is looked for in
    the same way, among the points left, at its last point, for motion may have stopped; and
    then at the point before, for its last one may be an impulse.

    A point that no track takes opens one. A track without a point stays open; but one that has
    fewer than `shortest` points yet ends at once. Tracks are named t000, t001, ... in the order
    of their first points, those of one frame by x, then y, then z. What a track has no point
    for is missing. Nothing depends on the order of the points within a frame, unless points
    coincide.

    Looks ahead 0 frames to link a frame's points, ``shortest - 1`` frames to drop short tracks,
    and to the take's end for a `gate` made from the data. Frame by frame, it needs a reference.

    Parameters
    ----------
    fade
        The share that is left of a track's velocity from frame to frame while it has no point: 1
        continues at constant velocity, 0 stays after the first frame.
    """
    method = _method(fade)
    return follow(given, method)


def _link(
    tracks: OpenTracks, points: NDArray[np.float64], frame: int, gate: float, fade: float
) -> Links:
    from nodegraph_track import linking_kernel

    expected = tracks.led_by_velocity(frame, fade)
    in_turn = np.array([expected, tracks.last, tracks.last - tracks.jump])
    return Links(expected, linking_kernel.assigned(in_turn, points, gate))
