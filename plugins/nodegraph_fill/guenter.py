"""Mean displacement of the nearest neighbours, the best surrounded marker first."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph_fill.stepwise import Rule, stepwise
from nodegraph_fill.tuning import Tune
from nodegraph_mocap import Trajectories


@stepwise(
    "fill.guenter",
    cite=("guenter1998", "zhang_scattered"),
)
def guenter(
    recording: Trajectories,
    *,
    neighbours: Annotated[int, Field(ge=1), Tune(2, 3, 5, 8)] = 3,
    ring: Annotated[int, Field(ge=1)] = 8,
) -> Rule:
    """Fill gaps with the mean displacement of the nearest neighbours (Guenter et al. 1998).

    ``P'[t, m] = P[t-1, m] + mean(P[t, i] - P[t-1, i])`` over the nearest neighbours i that are
    usable at both frames, as described in Zhang et al., who ran it with three.

    Of several markers missing in one frame, the one with the most usable among its `ring`
    nearest markers at t-1, whatever their state, goes first; ties go to the smaller mean
    distance to them, then to marker order. A sample filled at t is at once usable for the next.
    The order gives a defined result; it is not known to lower the error.


    Parameters
    ----------
    neighbours
        How many neighbours are averaged, fewer where there are fewer.
    ring
        How many nearest markers count when the order of a frame's missing markers is decided.
    """
    return Rule(weights="mean", neighbours=neighbours, ring=ring)
