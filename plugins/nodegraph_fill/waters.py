"""Displacement of the nearest neighbour, scaled as by a single muscle."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph import Unit
from nodegraph_fill.stepwise import Rule, stepwise
from nodegraph_fill.tuning import Tune
from nodegraph_mocap import Trajectories

Radius = Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("mm")]


@stepwise(
    "fill.waters",
    cite=("waters1987", "zhang_scattered"),
    adapted=(
        "from Waters 1987: the distance is that of the nearest neighbour, not of the muscle's "
        "attachment"
    ),
)
def waters(
    recording: Trajectories,
    *,
    full_radius: Annotated[Radius, Tune(times=(1 / 3,))] = 15.0,
    falloff_radius: Annotated[Radius, Tune(times=(2 / 3, 2.0))] = 45.0,
) -> Rule:
    """Fill gaps with the nearest neighbour's displacement, scaled by Waters' muscle (1987).

    ``P'[t, m] = P[t-1, m] + R (P[t, i] - P[t-1, i])``, with D the distance of the nearest
    usable neighbour i at t-1, R_s the `full_radius` and R_f the `falloff_radius`; equations 1
    and 2 of Zhang et al.: ``R = cos((1 - D / R_s) pi / 2)`` for D <= R_s,
    ``R = cos((D - R_s) / (R_f - R_s) pi / 2)`` up to R_f, 0 beyond.

    Waters measures D from the muscle's bony attachment, where nothing moves. With D the
    neighbour's distance, a neighbour that coincides with the marker gives R = 0, as does one
    beyond R_f: the marker then stays where it was for that step, counted in a warning.

    Markers missing in one frame are filled in marker order.

    Parameters
    ----------
    full_radius
        R_s, the distance at which the neighbour's whole displacement is taken over.
    falloff_radius
        R_f, the distance from which on none of it is; larger than `full_radius`.

    Raises
    ------
    ValueError
        If `full_radius` is not smaller than `falloff_radius`.
    """
    if not full_radius < falloff_radius:
        raise ValueError(
            f"full_radius must be smaller than falloff_radius, got {full_radius} and "
            f"{falloff_radius} mm"
        )
    return Rule(
        weights="waters",
        neighbours=1,
        full_radius=full_radius,
        falloff_radius=falloff_radius,
    )
