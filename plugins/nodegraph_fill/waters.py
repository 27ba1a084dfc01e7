"""Displacement of the nearest neighbour, scaled as by a single muscle."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph import Unit, node
from nodegraph_fill.gaps import MaxGap
from nodegraph_fill.meet_ends import Ends
from nodegraph_fill.stepwise import (
    CloseGap,
    Rule,
    fill_stepwise,
    live_form,
    lookahead,
    meets_ends,
)
from nodegraph_mocap import Trajectories


def _rule(
    recording: Trajectories, *, full_radius: float, falloff_radius: float, use_filled: bool
) -> Rule:
    if not full_radius < falloff_radius:
        raise ValueError(
            f"full_radius must be smaller than falloff_radius, got {full_radius} and "
            f"{falloff_radius} mm"
        )
    return Rule(
        weights="waters",
        neighbours=1,
        use_filled=use_filled,
        full_radius=full_radius,
        falloff_radius=falloff_radius,
    )


@node(
    "fill.waters",
    cite=("waters1987", "zhang_scattered"),
    adapted=(
        "from Waters 1987: the distance is that of the nearest neighbour, not of the muscle's "
        "attachment"
    ),
    lookahead=lookahead,
    ends=meets_ends,
    live=live_form(_rule),
)
def waters(
    recording: Trajectories,
    *,
    full_radius: Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("mm")] = 15.0,
    falloff_radius: Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("mm")] = 45.0,
    use_filled: bool = True,
    close_gap: CloseGap = "none",
    ends: Ends = "as_published",
    max_gap: MaxGap = None,
) -> Trajectories:
    """Fill gaps with the nearest neighbour's displacement, scaled by Waters' muscle (1987).

    ``P'[t, m] = P[t-1, m] + R (P[t, i] - P[t-1, i])``, with D the distance of the nearest
    usable neighbour i at t-1, R_s the `full_radius` and R_f the `falloff_radius`; equations 1
    and 2 of Zhang et al.: ``R = cos((1 - D / R_s) pi / 2)`` for D <= R_s,
    ``R = cos((D - R_s) / (R_f - R_s) pi / 2)`` up to R_f, 0 beyond.

    Waters measures D from the muscle's bony attachment, where nothing moves. With D the
    neighbour's distance, a neighbour that coincides with the marker gives R = 0, as does one
    beyond R_f: the marker then stays where it was for that step, counted in a warning.

    Markers missing in one frame are filled in marker order. A gap at the start of the take is
    filled backward from the marker's first sample. What has no usable neighbour stays missing,
    as does the rest of that gap, counted in a warning. Samples that are present come out bit
    for bit; those an earlier fill made count as filled.

    Looks ahead 0 frames, but for gaps at the start of the take; with a `max_gap` that many, to know
    that a gap is no longer; twice as many with `close_gap` ramp or `ends` met, up to the gap's end
    without a `max_gap`; with blend to the take's end. Frame by frame, gaps at the start of the
    take stay missing.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    full_radius
        R_s, the distance at which the neighbour's whole displacement is taken over.
    falloff_radius
        R_f, the distance from which on none of it is; larger than `full_radius`.
    use_filled
        Whether samples filled earlier serve as neighbours, after all measured ones.
    close_gap
        none: a jump stays where the marker reappears. ramp: that sample is predicted too and
        its mismatch e spread over the gap, ``e j / (L + 1)`` at the j-th of L frames. blend: a
        forward and a backward pass, cross-faded linearly; where one is missing, the other.
    ends
        met: the mismatch where the marker reappears is spread over the gap, a ramp, unless
        `close_gap` already sees to it. as_published: as `close_gap` has it.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.

    Raises
    ------
    ValueError
        If `full_radius` is not smaller than `falloff_radius`.
    """
    rule = _rule(
        recording, full_radius=full_radius, falloff_radius=falloff_radius, use_filled=use_filled
    )
    return fill_stepwise(recording, rule, close_gap=close_gap, ends=ends, max_gap=max_gap)
