"""The time that a method takes, where the times of a run can tell methods apart."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

import numpy as np

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
    from pandas import Series
    from scipy.special import chdtrc

    ranks = Series(np.concatenate(groups)).rank().to_numpy()
    apart = ranks - (len(ranks) + 1) / 2
    ends = np.cumsum([len(group) for group in groups])
    between = sum(part.sum() ** 2 / len(part) for part in np.split(apart, ends[:-1]))
    statistic = (len(ranks) - 1) * between / np.square(apart).sum()
    return float(chdtrc(len(groups) - 1, statistic))
