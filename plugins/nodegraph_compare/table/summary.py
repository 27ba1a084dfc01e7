"""The statistics of one group of methods, over the blocks that all of them have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.bootstrap import FEWEST
from nodegraph_compare.question import sign_of
from nodegraph_compare.statistics import Test, holm, p_values, range_quantile
from nodegraph_compare.ties import apart, differ, settled

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.bootstrap import Bootstrap
    from nodegraph_tables import BetterEnd


@dataclass(frozen=True)
class Differences:
    """Paired differences of each method to one of them; NaN for that one.

    Attributes
    ----------
    mean, low, high, p, better : (K,) arrays of float64
        Method minus baseline and its interval, the p of the test after Holm's correction, and
        the share of blocks in which the method is strictly better (NaN where neither end is).
    """

    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    p: NDArray[np.float64]
    better: NDArray[np.float64]


@dataclass(frozen=True)
class Summary:
    """Statistics of K methods over the N blocks that every usable method has.

    Attributes
    ----------
    group : Group
    values : (N, K) array of float64
        The complete blocks.
    end : str
        Which end of the metric is better.
    mean, rms, median, sd, low, high : (K,) arrays of float64
        NaN for a method without any number, or with too few blocks. Means that differ by
        rounding alone are equal.
    behind : (K,) array of bool
        Clearly worse than the best mean: the paired difference is larger than Tukey's range
        allows, 5 % over all pairs of methods.
    paired : Differences or None
        To the baseline.
    """

    group: Group
    values: NDArray[np.float64]
    end: BetterEnd
    mean: NDArray[np.float64]
    rms: NDArray[np.float64]
    median: NDArray[np.float64]
    sd: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    behind: NDArray[np.bool_]
    paired: Differences | None

    @property
    def best(self) -> int | None:
        """The column with the best mean, the first of equals; None if there is none."""
        places = np.flatnonzero(self.bests)
        return int(places[0]) if len(places) else None

    @property
    def bests(self) -> NDArray[np.bool_]:
        """(K,), True for the best mean and those equal to it, where there are others."""
        known = np.isfinite(self.mean)
        if not known.any() or self.end == "none":
            return np.zeros(known.shape, dtype=bool)
        signed = sign_of(self.end) * self.mean
        return np.asarray(signed == np.nanmin(signed))

    @property
    def marked(self) -> NDArray[np.bool_]:
        """(K,), `bests` where there is something that they are better than, or equal to."""
        return self.bests & (np.count_nonzero(np.isfinite(self.mean)) > 1)

    @property
    def ranked(self) -> list[int]:
        """The columns from the best mean to the worst, without any number last.

        Equal means, and all of a metric of which neither end is better, in the order of the graph.
        """
        if self.end == "none":
            return list(range(len(self.mean)))
        order: list[int] = np.argsort(sign_of(self.end) * self.mean, kind="stable").tolist()
        return order

    @property
    def blocks(self) -> NDArray[np.intp]:
        """(K,), the number of blocks used; 0 for a method without any number."""
        return np.where(np.isfinite(self.mean), len(self.values), 0)


def summarise(
    group: Group, end: BetterEnd, bootstrap: Bootstrap, *, against: Label | None, test: Test
) -> Summary:
    """Return the statistics of a group, with paired differences where there is a baseline.

    Parameters
    ----------
    group
        The values of its methods in its blocks.
    end
        Which end of the metric is better.
    bootstrap
        Of the intervals.
    against
        The baseline's label, if there is one.
    test
        Of the differences to it.
    """
    values = group.values[group.complete]
    blocks, methods = values.shape
    nothing = np.full(methods, np.nan)
    mean = settled(values.mean(axis=0), np.abs(values).mean(axis=0)) if blocks else nothing
    low, high = bootstrap.interval(values)
    paired = None
    if against in group.methods:
        paired = differences(values, group.methods.index(against), end, bootstrap, test)
    return Summary(
        group,
        values,
        end,
        mean=mean,
        rms=np.sqrt((values**2).mean(axis=0)) if blocks else nothing,
        median=np.median(values, axis=0) if blocks else nothing,
        sd=_sd(values) if blocks > 1 else nothing,
        low=low,
        high=high,
        behind=behind_best(values, mean, end),
        paired=paired,
    )


def _sd(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the standard deviations of columns, 0 where they differ by rounding alone."""
    sd = values.std(axis=0, ddof=1)
    return np.where(differ(values) | ~np.isfinite(sd), sd, 0.0)


def differences(
    values: NDArray[np.float64], baseline: int, end: BetterEnd, bootstrap: Bootstrap, test: Test
) -> Differences:
    """Return the paired differences of the columns of complete blocks to one of them.

    Parameters
    ----------
    values
        (B, K), a row per block; a column of NaN for a method without any number.
    baseline
        The column that all others are compared to.
    end
        Which end of the metric is better.
    bootstrap
        Of the intervals.
    test
        Of the differences.
    """
    paired = apart(values, values[:, [baseline]])
    paired[:, baseline] = np.nan
    known = np.asarray(np.isfinite(paired).any(axis=0))
    low, high = bootstrap.interval(paired)
    nothing = np.full(known.shape, np.nan)
    p = nothing.copy()
    p[known] = p_values(paired[:, known], test)
    lower = sign_of(end) * paired < 0.0
    counted = known & (end != "none")
    return Differences(
        mean=paired.mean(axis=0) if len(paired) else nothing,
        low=low,
        high=high,
        p=holm(p),
        better=np.where(counted, lower.mean(axis=0), np.nan) if len(paired) else nothing,
    )


def behind_best(
    values: NDArray[np.float64], mean: NDArray[np.float64], end: BetterEnd
) -> NDArray[np.bool_]:
    """Return which methods are apart from the best by Tukey's range of paired differences.

    Whichever happens to be the best is compared with all: as if all pairs were tested.

    Parameters
    ----------
    values
        (B, K), the complete blocks.
    mean
        (K,), of the columns.
    end
        Which end of the metric is better; of ``none``, no method is behind.
    """
    blocks = len(values)
    usable = int(np.isfinite(mean).sum())
    if end == "none" or usable < 2 or blocks < FEWEST:
        return np.zeros(mean.shape, dtype=bool)
    signed = sign_of(end) * values
    paired = apart(signed, signed[:, [int(np.nanargmin(sign_of(end) * mean))]])
    error = paired.std(axis=0, ddof=1) / np.sqrt(blocks)
    return np.asarray(paired.mean(axis=0) > range_quantile(usable, blocks - 1) * error)
