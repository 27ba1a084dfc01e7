"""The statistics of one group of methods, over the blocks that all of them have."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.inference import (
    FEWEST_FLIPPED,
    LEVEL,
    arithmetic_interval,
    contrasts,
    mean_interval,
)
from nodegraph_compare.question import sign_of
from nodegraph_compare.ties import settled
from nodegraph_compare.units import units_of
from nodegraph_compare.verdict import Paired

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Margin
    from nodegraph_compare.units import Units
    from nodegraph_tables import BetterEnd

_DOUBTFUL = 0.10


@dataclass(frozen=True)
class Summary:
    """Statistics of K methods over the N blocks that every usable method has.

    Attributes
    ----------
    group : Group
    units : Units
        The independent units, with the means of the usable methods.
    end : str
        Which end of the metric is better.
    ratio : bool
        Whether methods are compared by ratios, not by differences.
    mean, low, high, median, rank : (K,) arrays of float64
        Mean over units with its interval, median over blocks, and mean rank within blocks; NaN
        for a method without any number. Means that differ by rounding alone are equal.
    level : (K,) array of float64
        What decides, the lower the better: the mean of the logarithms of the units' means, or of
        these means.
    blocks : (K,) array of int
        Number of blocks used; 0 for a method without any number.
    against : int or None
        The place of the baseline.
    margin : Margin or None
        Within which methods count as equal.
    """

    group: Group
    units: Units
    end: BetterEnd
    ratio: bool
    mean: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    median: NDArray[np.float64]
    rank: NDArray[np.float64]
    level: NDArray[np.float64]
    blocks: NDArray[np.intp]
    against: int | None
    margin: Margin | None

    @property
    def best(self) -> int | None:
        """The column with the best mean, the first of equals; None if there is none."""
        places = np.flatnonzero(self.bests)
        return int(places[0]) if len(places) else None

    @property
    def bests(self) -> NDArray[np.bool_]:
        """(K,), True for the best mean and those equal to it, where there are others."""
        known = np.isfinite(self.level)
        if not known.any() or self.end == "none":
            return np.zeros(known.shape, dtype=bool)
        return np.asarray(self.level == np.nanmin(self.level))

    @property
    def best_by_mean(self) -> NDArray[np.bool_]:
        """(K,), True for the best mean over units, which need not be best by the mean ratio."""
        signed = sign_of(self.end) * self.mean
        return np.asarray(signed == np.nanmin(signed))

    @property
    def ranked(self) -> list[int]:
        """The columns from the best mean to the worst, without any number last.

        Equal means, and all of a metric of which neither end is better, in the order of the graph.
        """
        if self.end == "none":
            return list(range(len(self.level)))
        order: list[int] = np.argsort(self.level, kind="stable").tolist()
        return order

    @property
    def judged(self) -> bool:
        """Whether there are units enough for p and a verdict."""
        return self.units.judged

    @cached_property
    def to_best(self) -> Paired | None:
        """Differences of each method to the best one, if there is one and enough units."""
        return None if self.best is None else self._paired(self.best)

    @cached_property
    def paired(self) -> Paired | None:
        """Differences of each method to the baseline; to the best one if there is none."""
        return self.to_best if self.against is None else self._paired(self.against)

    @property
    def p_of_step(self) -> NDArray[np.float64]:
        """(K,), p of each method against the one before it; NaN for the first."""
        p = np.full(self.level.shape, np.nan)
        for place in range(1, len(p)):
            paired = self._paired(place - 1)
            p[place] = np.nan if paired is None else paired.p[place]
        return p

    def _paired(self, reference: int) -> Paired | None:
        usable = np.flatnonzero(np.isfinite(self.level))
        if len(usable) < 2 or reference not in usable or self.units.speech == "nothing":
            return None
        at = int(np.flatnonzero(usable == reference)[0])
        sign, strata = sign_of(self.end), self.units.strata
        y = sign * self.units.numbers(self.ratio)
        result = contrasts(y, at, strata)
        ends = [sign * end for end in result.interval][:: int(sign)]
        shown = np.exp if self.ratio else np.asarray
        margin = shown(result.margin)
        if self.ratio and self.margin is not None and not self.margin.ratio:
            margin = contrasts(sign * self.units.means, at, strata).margin
        flipped = self.judged and len(y) >= FEWEST_FLIPPED
        flips = result.p_of_flips if flipped else np.full(len(usable), np.nan)

        def spread(values: NDArray[np.float64]) -> NDArray[np.float64]:
            full = np.full(self.level.shape, np.nan)
            full[usable] = values
            full[reference] = np.nan
            return full

        doubtful = np.zeros(self.level.shape, dtype=bool)
        doubtful[usable] = (result.p_alone <= LEVEL) & (flips > _DOUBTFUL)
        low, high = (spread(shown(end)) for end in ends)
        mean = self.mean[reference]
        # the same verdict in the metric's unit
        differences = [mean * (end - 1) for end in (low, high)] if self.ratio else [low, high]
        apart = self.mean - mean
        apart[reference] = np.nan
        return Paired(
            reference,
            value=spread(shown(sign * result.mean)),
            low=low,
            high=high,
            difference=apart,
            difference_low=differences[0],
            difference_high=differences[1],
            p=spread(result.p if self.judged else np.full(len(usable), np.nan)),
            flips=spread(flips),
            effect=spread(result.effect),
            wins=spread((result.d < 0.0).sum(axis=0).astype(np.float64)),
            margin=spread(margin),
            doubtful=doubtful,
        )


def summarise(
    group: Group,
    end: BetterEnd,
    *,
    ratio: bool,
    against: Label | None = None,
    margin: Margin | None = None,
) -> Summary:
    """Return the statistics of a group.

    Parameters
    ----------
    group
        The values of its methods in its blocks.
    end
        Which end of the metric is better.
    ratio
        Whether to compare methods by ratios.
    against
        The baseline's label, if there is one.
    margin
        Within which methods count as equal.
    """
    from scipy.stats import rankdata

    usable, kept = group.usable, group.complete
    values = group.values[:, usable]
    units = units_of(group, values, kept)
    values = values[kept]
    many = len(values) > 0
    mean = units.means.mean(axis=0) if many else np.full(values.shape[1], np.nan)
    y = units.numbers(ratio) if many else units.means
    size = np.abs(units.means).mean(axis=0) if many else mean
    low, high = _ends(units, y, mean, ratio=ratio)
    sign = sign_of(end)
    level = sign * (y.mean(axis=0) if many else mean)

    def spread(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        full = np.full(usable.shape, np.nan)
        full[usable] = numbers
        return full

    place = group.methods.index(against) if against in group.methods else None
    return Summary(
        group,
        units,
        end,
        ratio,
        mean=spread(settled(mean, size)),
        low=spread(low),
        high=spread(high),
        median=spread(np.median(values, axis=0) if many else mean),
        rank=spread(rankdata(sign * values, axis=1).mean(axis=0) if many else mean),
        level=spread(settled(level, np.ones_like(level) if ratio else size)),
        blocks=np.where(usable, len(values), 0),
        against=place,
        margin=margin,
    )


def _ends(
    units: Units, y: NDArray[np.float64], mean: NDArray[np.float64], *, ratio: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the ends of the intervals of means; those of positive means stay above 0."""
    if units.speech == "nothing":
        return np.full(mean.shape, np.nan), np.full(mean.shape, np.nan)
    if not ratio:
        return mean_interval(units.means, units.strata)
    if units.kind == "clusters":
        low, high = arithmetic_interval(y)
        # the model's mean is not that of the data
        return np.minimum(low, mean), np.maximum(high, mean)
    low, high = mean_interval(y, units.strata)
    return np.exp(low), np.exp(high)


def by_ratio(groups: Sequence[Group], end: BetterEnd) -> bool:
    """Whether methods can be compared by ratios: every mean of a unit is above 0.

    Where neither end of a metric is the better one, values are differences, not errors.
    """
    return end != "none" and all(map(_positive, groups))


def _positive(group: Group) -> bool:
    values = group.values[:, group.usable]
    kept = group.complete
    if not kept.any():
        return True
    if np.nanmin(group.values[:, group.usable]) < 0.0:
        return False
    units = units_of(group, values, kept)
    means = units.means if units.kind == "clusters" else units.means.mean(axis=0)
    return bool((means > 1e-9 * means.max()).all())
