"""Wilcoxon's test of paired differences, its effect size, and Holm's correction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

TEST_NAMES = {
    "nemenyi": "Nemenyi's test",
    "wilcoxon_holm": "Wilcoxon's test with Holm's correction",
}
_MOST_SIGNS = 13


def signed_rank(differences: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the p of Wilcoxon's signed-rank test (1945) of each column.

    Differences of exactly zero are dropped, as Wilcoxon does; if all are zero, p is 1. Without
    ties and zeros the exact distribution is used for up to 50 blocks, with them for up to 13, else
    the normal approximation: as `scipy.stats.wilcoxon` does.
    """
    from scipy.stats import wilcoxon

    p = np.ones(differences.shape[1])
    some = np.any(differences != 0.0, axis=0)
    plain = some & _without_ties(differences)
    if plain.any():
        p[plain] = wilcoxon(differences[:, plain], axis=0).pvalue
    few = len(differences) <= _MOST_SIGNS
    for place in np.flatnonzero(some & ~plain):
        column = differences[:, place]
        p[place] = _exact(column) if few else wilcoxon(column).pvalue
    return p


def rank_biserial(differences: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the matched-pairs rank-biserial correlation of each column (Kerby 2014).

    ``(W+ - W-) / (W+ + W-)`` with the rank sums of Wilcoxon's test: 1 where every difference is
    above zero, -1 where every one is below, 0 where all are zero.
    """
    from pandas import DataFrame

    sizes = np.where(differences == 0.0, np.nan, np.abs(differences))
    ranks = DataFrame(sizes).rank().fillna(0.0).to_numpy()
    total = ranks.sum(axis=0)
    signed = (np.sign(differences) * ranks).sum(axis=0)
    return np.asarray(signed / np.where(total > 0.0, total, 1.0))


def holm(p: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return p values adjusted for their number by Holm's step-down method (1979).

    The i-th smallest of n, from 0, becomes the largest of ``(n - j) p_j`` over ``j <= i``, at
    most 1. NaN stays NaN and does not count.
    """
    adjusted = np.full(p.shape, np.nan)
    known = np.flatnonzero(~np.isnan(p))
    order = known[np.argsort(p[known], kind="stable")]
    factors = np.arange(len(order), 0, -1)
    adjusted[order] = np.minimum(np.maximum.accumulate(factors * p[order]), 1.0)
    return adjusted


def _exact(differences: NDArray[np.float64]) -> float:
    """Return the p of the signed-rank test over all signs that the differences could have.

    The same as scipy's permutations of tied differences, in a thousandth of their time.
    """
    from pandas import Series

    some = differences[differences != 0.0]
    ranks = Series(np.abs(some)).rank().to_numpy()
    signs = (np.arange(2 ** len(some))[:, np.newaxis] >> np.arange(len(some))) & 1
    # ranks are halves: their sums are exact
    sums, observed = signs @ ranks, float(ranks[some > 0.0].sum())
    tail = min(np.count_nonzero(sums <= observed), np.count_nonzero(sums >= observed))
    return min(1.0, 2 * tail / len(sums))


def _without_ties(differences: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return, per column, whether it may be tested with others at once."""
    sizes = np.sort(np.abs(differences), axis=0)
    distinct = (np.diff(sizes, axis=0) > 0.0).all(axis=0)
    return np.asarray(distinct & (sizes[0] > 0.0))
