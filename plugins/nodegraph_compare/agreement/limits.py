"""Bias and limits of agreement of two methods."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_compare.inference import CONFIDENCE
from nodegraph_compare.ties import apart, differ
from nodegraph_compare.units import MOST_RECORDINGS

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


def limits(
    first: NDArray[np.float64],
    second: NDArray[np.float64],
    cluster: NDArray[np.intp] | None = None,
) -> Limits:
    """Return bias and limits of agreement (Bland & Altman 1986) with exact normal intervals.

    The limits are ``bias -+ 1.96 sd``. The interval of the bias is Student's. That of a limit,
    which estimates ``mu -+ 1.96 sigma``, is exact for normal differences (Carkeet 2015): its ends
    are ``bias + t sd / sqrt(N)`` with t the quantiles of the noncentral t distribution of N - 1
    degrees of freedom and noncentrality ``-+ 1.96 sqrt(N)``. The slope is that of the least-squares
    line of the difference on the mean of the pair (Bland & Altman 1999), its interval Student's.

    Over C clusters, three or more, the bias is the mean of the clusters' means, and the variance
    that of a single pair, between and within them: with s^2 the pooled variance within, and n_c
    pairs in each, ``sd^2 = max(var(means) - s^2 mean(1 / n_c), 0) + s^2`` (Bland & Altman 1999,
    section 5.3). Intervals are those of C pairs, and the slope is that of the clusters' means.
    """
    difference, middle = apart(first, second), (first + second) / 2
    count = len(difference)
    bias = float(difference.mean()) if count else np.nan
    sd = float(difference.std(ddof=1)) if count > 1 else np.nan
    of, place = (
        (np.empty(0), np.empty(0)) if cluster is None else np.unique(cluster, return_inverse=True)
    )
    along = (middle, difference)
    if len(of) > MOST_RECORDINGS:
        blocks = np.bincount(place)
        means = np.bincount(place, difference) / blocks
        along = (np.bincount(place, middle) / blocks, means)
        freedom = max(count - len(of), 1)
        within = float(np.square(difference - means[place]).sum()) / freedom
        between = max(float(means.var(ddof=1)) - within * float((1 / blocks).mean()), 0.0)
        bias, sd, count = float(means.mean()), float(np.sqrt(between + within)), len(of)
    slope, of_slope = _slope(*along)
    return Limits(
        middle,
        difference,
        bias,
        sd,
        lower=bias - REACH * sd,
        upper=bias + REACH * sd,
        slope=slope,
        of_bias=_bound(bias, float(along[1].std(ddof=1)) if count > 1 else sd, count, 0.0),
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
        known = np.isfinite(both).all(axis=1)
        agreement = limits(both[known, 0], both[known, 1], group.cluster[known])
        names = group.methods
        yield Pair(group, names[first], names[second], agreement)
