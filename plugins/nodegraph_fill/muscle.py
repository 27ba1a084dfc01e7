"""Displacements of the three nearest neighbours, weighted as three muscles."""

from __future__ import annotations

from typing import Annotated

from nodegraph_fill.stepwise import Rule, stepwise
from nodegraph_fill.tuning import Tune
from nodegraph_mocap import Trajectories


@stepwise(
    "fill.muscle",
    cite="zhang_scattered",
)
def muscle(
    recording: Trajectories,
    *,
    normalize: Annotated[bool, Tune(False, True)] = False,
) -> Rule:
    """Fill gaps with the weighted motion of the three nearest neighbours (Zhang et al.).

    Equations 3 to 5, with d_i the distance of neighbour i at t-1 and d_all their sum:
    ``w_i = [(1 + cos(pi d_i / d_all)) / 2]^4`` and
    ``P'[t, m] = P[t-1, m] + sum(w_i (P[t, i] - P[t-1, i]))``.

    The weights' sum is not 1: 243/256 at equal distances (the least), 1.125 at distances
    (0, 1, 1), 2 at (0, 0, 1); `normalize` divides by it. With d_all = 0 each weight is 1/3. With
    fewer than three usable neighbours, where the formula would give one of them weight 0 and
    two equal ones 0.125 in all, the weights are their normalised inverse distances.

    Markers missing in one frame are filled in marker order.

    Parameters
    ----------
    normalize
        Whether the weights are divided by their sum, which the paper does not do.
    """
    weights = "muscle_normalized" if normalize else "muscle"
    return Rule(weights=weights, neighbours=3)
