"""Displacements of the three nearest neighbours, weighted as three muscles."""

from __future__ import annotations

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


def _rule(recording: Trajectories, *, normalize: bool, use_filled: bool) -> Rule:
    weights = "muscle_normalized" if normalize else "muscle"
    return Rule(weights=weights, neighbours=3, use_filled=use_filled)


@node(
    "fill.muscle",
    cite="zhang_scattered",
    lookahead=lookahead,
    ends=meets_ends,
    live=live_form(_rule),
)
def muscle(
    recording: Trajectories,
    *,
    normalize: bool = False,
    use_filled: bool = True,
    close_gap: CloseGap = "none",
    ends: Ends = "as_published",
    max_gap: MaxGap = None,
) -> Trajectories:
    """Fill gaps with the weighted motion of the three nearest neighbours (Zhang et al.).

    Equations 3 to 5, with d_i the distance of neighbour i at t-1 and d_all their sum:
    ``w_i = [(1 + cos(pi d_i / d_all)) / 2]^4`` and
    ``P'[t, m] = P[t-1, m] + sum(w_i (P[t, i] - P[t-1, i]))``.

    The weights' sum is not 1: 243/256 at equal distances (the least), 1.125 at distances
    (0, 1, 1), 2 at (0, 0, 1); `normalize` divides by it. With d_all = 0 each weight is 1/3. With
    fewer than three usable neighbours, where the formula would give one of them weight 0 and
    two equal ones 0.125 in all, the weights are their normalised inverse distances.

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
    normalize
        Whether the weights are divided by their sum, which the paper does not do.
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
    rule = _rule(recording, normalize=normalize, use_filled=use_filled)
    return fill_stepwise(recording, rule, close_gap=close_gap, ends=ends, max_gap=max_gap)
