"""The take as a matrix of low rank, as far as its missing samples allow."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph_fill.gaps import Gaps
from nodegraph_fill.low_rank import LowRank
from nodegraph_fill.tuning import Tune
from nodegraph_fill.whole_take import Estimate, TakeMatrix, whole_take
from nodegraph_mocap import Trajectories


@whole_take("fill.soft_impute", cite="mazumder2010")
def soft_impute(
    recording: Trajectories,
    gaps: Gaps,
    *,
    shrinkage: Annotated[float, Field(gt=0, lt=1), Tune(0.001, 0.003, 0.01)] = 0.001,
) -> Estimate:
    """Fill gaps from a matrix of low rank that is near the samples (Mazumder et al., 2010).

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

    Does not depend on where the origin lies, how the axes are turned, or the unit. The
    head's motion is part of the matrix: remove it first, where it is large.

    Looks at the whole take.

    Parameters
    ----------
    shrinkage
        Share of the largest singular value by which all of them shrink: the larger, the lower
        the rank.
    """
    matrix = TakeMatrix.of(recording)
    low_rank = LowRank.of(recording, shrinkage)
    hidden = matrix.hidden_ends(gaps)
    rows = low_rank.completed(matrix.rows[hidden.frame], hidden.missing)
    ends = hidden.of_gaps(matrix.positions(rows))
    positions = matrix.positions(low_rank.rows)
    return Estimate(positions, ends=ends, unsettled=low_rank.unsettled)
