"""The distribution of the range of k means over their standard error, for many values at once.

``P(Q > q) = integral of f(s) S(q s)`` over s, with f the density of ``sqrt(chi2(df) / df)`` and
S of the range of k standard normals, ``P(R > w) = k integral of phi(z) (Phi(z)^(k - 1) -
(Phi(z) - Phi(z - w))^(k - 1))`` over z (Lund & Lund 1983). Both are summed on even grids, of z and
of ``log s``, which is exact to rounding for functions as smooth as these.
`scipy.stats.studentized_range`, which chooses its own grid for each q, is as right to 1e-11 and
takes a hundred times as long.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

_Z = np.arange(-8.5, 9.0, 0.15)
_AT_A_TIME = 64
"""Values of q, which bounds the memory."""


def survival(q: Numbers, means: int, freedom: float) -> Numbers:
    """Return P(Q > q), (N,), of the range of some means, with degrees of freedom or infinity.

    Its absolute error is some 1e-15: smaller probabilities mean nothing.
    """
    scale, weight = _scales(freedom)
    parts = np.array_split(q, range(_AT_A_TIME, len(q), _AT_A_TIME))
    p = [_mean(_of_normals(np.multiply.outer(part, scale), means), weight) for part in parts]
    return np.where(q == 0.0, 1.0, np.clip(np.concatenate(p), 0.0, 1.0))


def quantile(p: float, means: int, freedom: float) -> float:
    """Return the q that the range exceeds with probability p."""
    from scipy.optimize import brentq

    def excess(q: float) -> float:
        return float(survival(np.array([q]), means, freedom)[0]) - p

    high = 4.0
    while excess(high) > 0.0:
        high *= 2.0
    return float(brentq(excess, 0.0, high, xtol=1e-13))


def _scales(freedom: float) -> tuple[Numbers, Numbers]:
    """Return values of s and their weights."""
    if np.isinf(freedom):
        return np.ones(1), np.ones(1)
    reach = np.sqrt(40.0 / freedom)  # beyond it the density is below exp(-40) of its highest
    step = min(0.07, 0.5 / np.sqrt(freedom))
    log_s = np.arange(-reach - 40.0 / freedom, reach + step, step)
    density = np.exp(freedom * (log_s - np.expm1(2 * log_s) / 2))  # over log s, times a constant
    return np.exp(log_s), density / density.sum()


def _of_normals(w: Numbers, means: int) -> Numbers:
    """Return P(R > w) for the range R of standard normals."""
    from scipy.special import ndtr

    below = ndtr(_Z)
    weight = np.exp(-np.square(_Z) / 2) * below ** (means - 1)
    within = np.minimum(ndtr(_Z - w[..., np.newaxis]) / below, 1.0)
    with np.errstate(divide="ignore"):  # of a range of 0
        powers = -np.expm1((means - 1) * np.log1p(-within))  # no difference of nearly equal numbers
    return _mean(powers, weight / weight.sum())


def _mean(values: Numbers, weight: Numbers) -> Numbers:
    """Return a weighted mean over the last axis, to the same bit however many there are.

    A product of matrices adds in another order for another number of rows.
    """
    return np.asarray((values * weight).sum(axis=-1))
