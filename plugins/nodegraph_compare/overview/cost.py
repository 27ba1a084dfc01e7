"""The time that a method takes, where the times of a run can tell methods apart."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

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
    from scipy.stats import kruskal

    later = {
        label: sorted(seconds)[:-1] for label, seconds in times.items() if len(seconds) >= _FEWEST
    }
    if len(later) < 2 or len({second for seconds in later.values() for second in seconds}) < 2:
        return {}
    if kruskal(*later.values()).pvalue > _LEVEL:
        return {}
    return {label: median(seconds) for label, seconds in later.items()}
