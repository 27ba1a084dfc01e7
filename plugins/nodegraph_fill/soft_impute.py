"""The take as a matrix of low rank, as far as its missing samples allow."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from nodegraph import node
from nodegraph_fill.gaps import Gaps, MaxGap
from nodegraph_fill.low_rank import LowRank
from nodegraph_fill.meet_ends import Ends, are_met
from nodegraph_fill.whole_take import Estimate, TakeMatrix, fill_from
from nodegraph_mocap import Trajectories


@node("fill.soft_impute", cite="mazumder2010", lookahead=None, ends=are_met)
def soft_impute(
    recording: Trajectories,
    *,
    shrinkage: Annotated[float, Field(gt=0, lt=1)] = 0.001,
    ends: Ends = "as_published",
    max_gap: MaxGap = None,
) -> Trajectories:
    """Fill gaps from the matrix of least nuclear norm near the samples (Mazumder et al., 2010).

    The take is a matrix X of a row per frame and three columns per marker, each without its
    mean. Sought is the Z with the least
    ``sum over present samples of (X - Z)^2 / 2 + s |Z|_*``, the nuclear norm being the sum of
    the singular values, with s the `shrinkage` times the largest singular value of X with zeros
    where it is missing. Its entries fill the gaps. No frame need be complete.

    The problem is that of Soft-Impute, and so is its answer; the way there is shorter. Instead
    of one shrinkage of the singular values per round, X completed by the Z before, each round
    keeps ``M = V max(0, 1 - s / d) V'`` from the singular values d and vectors V of the
    completed X and solves, frame by frame, for missing entries that M gives back:
    ``x_m = M_mo x_o + M_mm x_m``, and Newton's method ends it, when a step changes nothing to 10
    digits.

    For `ends` met, the estimate beside a gap is what M gives when the samples there are hidden
    like those in the gap: Z itself is near every sample it has seen, and so would tell nothing
    about its error in the gap.

    A marker that is never measured stays missing, counted in a warning. Samples that are
    present come out as they went in; those that an earlier fill has made count like measured
    ones. Does not depend on where the origin lies, how the axes are turned, or the unit. The
    head's motion is part of the matrix: remove it first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    shrinkage
        Share of the largest singular value by which all of them shrink: the larger, the lower
        the rank.
    ends
        as_published: the estimate as it is. met: its mismatch at each end of a gap, sample minus
        estimate, is spread linearly over the gap, all of it at that end and none at the other;
        a gap that the take begins or ends with has one end.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """

    def model(recording: Trajectories, gaps: Gaps) -> Estimate:
        matrix = TakeMatrix.of(recording)
        low_rank = LowRank(matrix, shrinkage)
        estimate = Estimate(matrix.positions(low_rank.rows))
        if ends == "as_published":
            return estimate
        hidden = matrix.hidden_ends(gaps)
        beside = low_rank.completed(matrix.rows[hidden.frame], hidden.missing)
        return replace(estimate, ends=hidden.of_gaps(matrix.positions(beside)))

    return fill_from(recording, max_gap, model, ends=ends)
