"""Mean displacement of the nearest neighbours, the best surrounded marker first."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph import node
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


def _rule(recording: Trajectories, *, neighbours: int, ring: int, use_filled: bool) -> Rule:
    return Rule(weights="mean", neighbours=neighbours, use_filled=use_filled, ring=ring)


@node(
    "fill.guenter",
    cite=("guenter1998", "zhang_scattered"),
    lookahead=lookahead,
    ends=meets_ends,
    live=live_form(_rule),
)
def guenter(
    recording: Trajectories,
    *,
    neighbours: Annotated[int, Field(ge=1)] = 3,
    ring: Annotated[int, Field(ge=1)] = 8,
    use_filled: bool = True,
    close_gap: CloseGap = "none",
    ends: Ends = "as_published",
    max_gap: MaxGap = None,
) -> Trajectories:
    """Fill gaps with the mean displacement of the nearest neighbours (Guenter et al. 1998).

    ``P'[t, m] = P[t-1, m] + mean(P[t, i] - P[t-1, i])`` over the nearest neighbours i that are
    usable at both frames, as described in Zhang et al., who ran it with three.

    Of several markers missing in one frame, the one with the most usable among its `ring`
    nearest markers at t-1, whatever their state, goes first; ties go to the smaller mean
    distance to them, then to marker order. A sample filled at t is at once usable for the next.
    The order gives a defined result; it is not known to lower the error.

    A gap at the start of the take is filled backward from the marker's first sample. What has
    no usable neighbour stays missing, as does the rest of that gap, counted in a warning.
    Samples that are present come out bit for bit; those an earlier fill made count as filled.

    Looks ahead 0 frames, but for gaps at the start of the take; with a `max_gap` that many, to know
    that a gap is no longer; twice as many with `close_gap` ramp or `ends` met, up to the gap's end
    without a `max_gap`; with blend to the take's end. Frame by frame, gaps at the start of the
    take stay missing.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    neighbours
        How many neighbours are averaged, fewer where there are fewer.
    ring
        How many nearest markers count when the order of a frame's missing markers is decided.
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
    """
    rule = _rule(recording, neighbours=neighbours, ring=ring, use_filled=use_filled)
    return fill_stepwise(recording, rule, close_gap=close_gap, ends=ends, max_gap=max_gap)
