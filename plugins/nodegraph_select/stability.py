"""Which of many selections is the most stable one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Stability = Literal["sum", "mean", "medoid"]

_AT_ONCE = 256
"""Selections that are compared with all others at once, so that many runs fit into memory."""
_DIGITS = 12
"""To which sums of likenesses are rounded: equal ones may come in another order."""


@dataclass(frozen=True, eq=False)
class Stabilities:
    """How often pairs were chosen, and how stable that makes each of R selections.

    Attributes
    ----------
    frequencies : (P,) array of float64
        Share of the selections that have each pair.
    sum, mean : (R,) array of float64
        Of the frequencies of a selection's pairs.
    medoid : (R,) array of float64
        Mean Jaccard index, shared pairs by pairs of either, of a selection and each of all R.
    same : (R,) array of int
        The number of the selection, equal ones having the same, counted as they first come.
    """

    frequencies: NDArray[np.float64]
    sum: NDArray[np.float64]
    mean: NDArray[np.float64]
    medoid: NDArray[np.float64]
    same: NDArray[np.intp]

    @property
    def distinct(self) -> int:
        """How many of the selections differ."""
        return int(self.same.max()) + 1

    def best(self, stability: Stability, markers: NDArray[np.intp]) -> int:
        """Return the most stable selection; of equals one of fewer markers, then the first."""
        score: NDArray[np.float64] = getattr(self, stability)
        return int(np.lexsort((np.arange(len(score)), markers, -score))[0])


def stabilities(chosen: NDArray[np.bool_]) -> Stabilities:
    """Return how stable selections are.

    Parameters
    ----------
    chosen : (R, P) array of bool
        Which pairs each selection has, at least one.
    """
    runs = len(chosen)
    counts = np.count_nonzero(chosen, axis=0)
    # sums of whole numbers: the same in any order, so that equals are equal
    total = chosen @ counts
    same, kinds, how_often = _kinds(chosen)
    return Stabilities(
        frequencies=counts / runs,
        sum=total / runs,
        mean=total / np.count_nonzero(chosen, axis=1) / runs,
        medoid=np.round(_mean_likeness(kinds, how_often), _DIGITS)[same],
        same=same,
    )


def _kinds(
    chosen: NDArray[np.bool_],
) -> tuple[NDArray[np.intp], NDArray[np.bool_], NDArray[np.intp]]:
    """Return the number of each selection's kind, the kinds, and how often each came."""
    packed = np.packbits(chosen, axis=1)
    _, first, inverse, counts = np.unique(
        packed, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    order = np.argsort(first)
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    return number[inverse.reshape(-1)], chosen[first[order]], counts[order]


def _mean_likeness(kinds: NDArray[np.bool_], how_often: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return each kind's mean Jaccard index with all selections."""
    pairs = kinds.astype(np.float64)
    size = pairs.sum(axis=1)
    likeness = np.empty(len(pairs))
    for start in range(0, len(pairs), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        shared = pairs[some] @ pairs.T
        likeness[some] = shared / (size[some, None] + size - shared) @ how_often
    return np.asarray(likeness / how_often.sum())
