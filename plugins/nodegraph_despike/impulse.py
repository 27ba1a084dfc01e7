"""Two long steps in a row: the impulse filter of Zhang, Liang and Wei."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_despike.repair import repaired
from nodegraph_mocap import Trajectories

Order = Literal["simultaneous", "in_place", "redetect"]


@node("despike.impulse", cite="zhang_scattered", lookahead=None)
def impulse(
    recording: Trajectories,
    *,
    factor: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = 1.5,
    order: Order = "simultaneous",
) -> Trajectories:
    """Repair samples between two long steps (Zhang et al.).

    Equations 8 to 10, for each marker by itself: with ``l_i = |P_i - P_{i-1}|`` between samples
    that are both present, and k the mean of all l of the marker, taken once and before any
    change, the sample ``P_i`` is bad when ``l_i >= factor k`` and ``l_{i+1} >= factor k``, and
    is put at the midpoint ``(P_{i-1} + P_{i+1}) / 2`` ("mid-value" is not a median).

    A sample of which a neighbour is missing is not bad, nor is the first or the last one; where
    k = 0, the marker stands still, and nothing is bad. So an impulse of one frame is found, one
    of two or three frames is not. The rule takes fast motion for noise: of a clean sinusoid it
    flags 10 % at a period of 20 frames, 18 % at 100, 19 % at most, and as much of a clean face.
    How many samples were repaired, and by how much, is in a warning; what an earlier method has
    filled or repaired counts as present.

    Looks ahead 1 frame to judge and repair a sample, and to the take's end for k.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    factor
        How many times the mean step a step must be to be long.
    order
        simultaneous (the paper): all bad samples are found, then each is repaired from its
        neighbours as they came; of impulses in frames 10 and 12, the good frame 11 is bad too,
        and becomes an impulse. in_place: one pass forward, each frame judged and repaired after
        the one before it. redetect: the worst sample, with the largest distance from its
        midpoint, the earliest of equals, is repaired and everything judged again, until none is
        bad; each is repaired at most once.

    Returns
    -------
    Trajectories
        The recording with repaired samples, their origin `Origin.REPAIRED`, their sigma NaN.

    Raises
    ------
    ValueError
        If the order is none of its choices.
    """
    from nodegraph_despike import impulse_kernel

    if order not in get_args(Order):
        raise ValueError(f"order must be simultaneous, in_place or redetect, got {order!r}")
    positions = np.ascontiguousarray(recording.positions)
    return repaired(recording, getattr(impulse_kernel, order)(positions, float(factor)))
