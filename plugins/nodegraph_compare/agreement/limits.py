"""Bias and limits of agreement of two methods."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_compare.inference import CONFIDENCE
from nodegraph_compare.ties import apart, differ

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group

Interval = tuple[float, float]
_UNKNOWN = (np.nan, np.nan)
REACH = 1.959963984540054
"""Standard deviations between which 95 % of a normal distribution lie."""


@dataclass(frozen=True)
class Limits:
    """Bland and Altman's numbers for N pairs; intervals are of 95 %, NaN where N is too small.

    Attributes
    ----------
    middle, difference : (N,) arrays of float64
        Mean of each pair, and first minus second.
    bias, sd, lower, upper, slope : float
        Mean and standard deviation of the differences, limits of agreement, and by how much the
        difference grows with the mean of the pair.
    of_bias, of_lower, of_upper, of_slope : (low, high)
    """

    middle: NDArray[np.float64]
    difference: NDArray[np.float64]
    bias: float
    sd: float
    lower: float
    upper: float
    slope: float
    of_bias: Interval
    of_lower: Interval
    of_upper: Interval
    of_slope: Interval


def limits(first: NDArray[np.float64], second: NDArray[np.float64]) -> Limits:
    """Return bias and limits of agreement (Bland & Altman 1986) with exact normal intervals.

    The limits are ``bias -+ 1.96 sd``. The interval of the bias is Student's. That of a limit,
    which estimates ``mu -+ 1.96 sigma``, is exact for normal differences (Carkeet 2015): its ends
    are ``bias + t sd / sqrt(N)`` with t the quantiles of the noncentral t distribution of N - 1
    degrees of freedom and noncentrality ``-+ 1.96 sqrt(N)``. The slope is that of the least-squares
    line of the difference on the mean of the pair (Bland & Altman 1999), its interval Student's.
    """
    difference, middle = apart(first, second), (first + second) / 2
    count = len(difference)
    bias = float(difference.mean()) if count else np.nan
    sd = float(difference.std(ddof=1)) if count > 1 else np.nan
    slope, of_slope = _slope(middle, difference)
    return Limits(
        middle,
        difference,
        bias,
        sd,
        lower=bias - REACH * sd,
        upper=bias + REACH * sd,
        slope=slope,
        of_bias=_bound(bias, sd, count, 0.0),
        of_lower=_bound(bias, sd, count, -REACH),
        of_upper=_bound(bias, sd, count, REACH),
        of_slope=of_slope,
    )


def _bound(bias: float, sd: float, count: int, reach: float) -> Interval:
    """Return the interval of ``mu + reach sigma`` of a normal distribution."""
    if count < 2:
        return _UNKNOWN
    from scipy.stats import nct

    root = np.sqrt(count)
    tail = (1 - CONFIDENCE) / 2
    low, high = (float(nct.ppf(share, count - 1, reach * root)) for share in (tail, 1 - tail))
    return float(bias + low * sd / root), float(bias + high * sd / root)


def _slope(middle: NDArray[np.float64], difference: NDArray[np.float64]) -> tuple[float, Interval]:
    count = len(middle)
    if count < 2 or not differ(middle):
        return np.nan, _UNKNOWN
    along = middle - middle.mean()
    spread = float(along @ along)
    slope = float(along @ difference) / spread if np.ptp(difference) > 0.0 else 0.0
    if count < 3:
        return slope, _UNKNOWN
    from scipy.stats import t

    left = difference - difference.mean() - slope * along
    error = np.sqrt(float(left @ left) / (count - 2) / spread)
    reach = float(t.ppf((1 + CONFIDENCE) / 2, count - 2)) * error
    return slope, (slope - reach, slope + reach)


class Pair(NamedTuple):
    """Two labels of a group, and how far they agree over the blocks that both have."""

    group: Group
    first: Label
    second: Label
    limits: Limits


def pairs_of(group: Group, baseline: Label | None) -> Iterator[Pair]:
    """Yield each pair of labels of a group, or only those with the baseline, as the second."""
    if baseline is None:
        places = list(combinations(range(len(group.methods)), 2))
    else:
        bases = [at for at, method in enumerate(group.methods) if method == baseline]
        places = [(at, other) for other in bases for at in range(len(group.methods)) if at != other]
    for first, second in places:
        both = group.values[:, [first, second]]
        both = both[np.isfinite(both).all(axis=1)]
        names = group.methods
        yield Pair(group, names[first], names[second], limits(both[:, 0], both[:, 1]))
