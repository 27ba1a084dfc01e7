"""The time that a method takes, where the times of a run can tell methods apart."""

from __future__ import annotations

from math import erfc, exp, pi, sqrt
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.midranks import midranks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph import Label

_FEWEST = 4
"""Results of a method whose times say anything."""

_LEVEL = 0.05


def typical_seconds(times: Mapping[Label, Sequence[float]]) -> dict[Label, float]:
    """Return the median time of each method that has four or more, without its longest.

    That is the time of a first call, which compiles or imports what the method needs. Empty where
    methods differ no more than the times of a method do, by the test of Kruskal and Wallis (1952).
    """
    later = {
        label: sorted(seconds)[:-1] for label, seconds in times.items() if len(seconds) >= _FEWEST
    }
    if len(later) < 2 or len({second for seconds in later.values() for second in seconds}) < 2:
        return {}
    if _p_of_equal([*later.values()]) > _LEVEL:
        return {}
    return {label: median(seconds) for label, seconds in later.items()}


def _p_of_equal(groups: Sequence[Sequence[float]]) -> float:
    """Return the p of the test of Kruskal and Wallis, corrected for ties."""
    ranks = midranks(np.concatenate(groups))
    apart = ranks - (len(ranks) + 1) / 2
    ends = np.cumsum([len(group) for group in groups])
    between = sum(part.sum() ** 2 / len(part) for part in np.split(apart, ends[:-1]))
    statistic = (len(ranks) - 1) * between / np.square(apart).sum()
    return _tail_of_chi_square(float(statistic), len(groups) - 1)


def _tail_of_chi_square(value: float, degrees: int) -> float:
    """Return the probability of more than a value; without SciPy, which takes long to import."""
    half = value / 2
    if degrees % 2:
        shape, tail, step = 0.5, erfc(sqrt(half)), 2 * sqrt(half / pi) * exp(-half)
    else:
        shape, tail, step = 1.0, exp(-half), half * exp(-half)
    while shape < degrees / 2:  # Q(a + 1, x) = Q(a, x) + x^a exp(-x) / gamma(a + 1)
        tail += step
        shape += 1
        step *= half / shape
    return tail
