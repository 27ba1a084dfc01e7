"""The statistics of one group of methods, over the blocks that all of them have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.inference import (
    FEWEST_FLIPPED,
    LEVEL,
    contrasts,
    mean_interval,
)
from nodegraph_compare.question import sign_of
from nodegraph_compare.ties import settled
from nodegraph_compare.units import segments_of, units_of
from nodegraph_compare.verdict import Paired

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.question import Margin
    from nodegraph_compare.units import Units
    from nodegraph_tables import BetterEnd

UnitsOf = Callable[["Group", "NDArray[np.float64]", "NDArray[np.bool_]"], "Units"]


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
    mean, low, high : (K,) arrays of float64
        The number that decides, with its interval: the geometric mean over clusters, or, where
        methods are compared by differences, the arithmetic one. Numbers that differ by rounding
        alone are equal.
    arithmetic, median, rank : (K,) arrays of float64
        Mean over clusters, median over blocks, and mean rank within blocks. All six are NaN for a
        method without any number.
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
    arithmetic: NDArray[np.float64]
    median: NDArray[np.float64]
    rank: NDArray[np.float64]
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
        known = np.isfinite(self.mean)
        if not known.any() or self.end == "none":
            return np.zeros(known.shape, dtype=bool)
        signed = sign_of(self.end) * self.mean
        return np.asarray(signed == np.nanmin(signed))

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
        """(K,), p of each method against the one before it; NaN for the first.

        All of them are of one comparison of all pairs, which is not repeated for those left.
        """
        p = np.full(self.mean.shape, np.nan)
        for place in range(1, len(p)):
            paired = self._paired(place - 1, in_steps=False)
            p[place] = np.nan if paired is None else paired.p[place]
        return p

    def _paired(self, reference: int, *, in_steps: bool = True) -> Paired | None:
        usable = np.flatnonzero(np.isfinite(self.mean))
        if len(usable) < 2 or reference not in usable or self.units.speech == "nothing":
            return None
        at = int(np.flatnonzero(usable == reference)[0])
        sign, parts = sign_of(self.end), self.units.parts
        y = sign * self.units.numbers(self.ratio)
        result = contrasts(y, at, parts, in_steps=in_steps)
        ends = [sign * end for end in (result.low, result.high)][:: int(sign)]
        shown = np.exp if self.ratio else np.asarray
        margin = shown(result.margin)
        if self.ratio and self.margin is not None and not self.margin.ratio:
            plain = sign * self.units.numbers(ratio=False)
            margin = contrasts(plain, at, parts, in_steps=False).margin
        flipped = self.judged and len(y) >= FEWEST_FLIPPED
        flips = result.p_of_flips if flipped else np.full(len(usable), np.nan)

        def spread(values: NDArray[np.float64]) -> NDArray[np.float64]:
            full = np.full(self.mean.shape, np.nan)
            full[usable] = values
            full[reference] = np.nan
            return full

        alone = np.zeros(self.mean.shape, dtype=bool)
        alone[usable] = result.p_alone <= LEVEL
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
            losses=spread((result.d > 0.0).sum(axis=0).astype(np.float64)),
            margin=spread(margin),
            alone=alone,
        )


def summarise(
    group: Group,
    end: BetterEnd,
    *,
    ratio: bool,
    against: Label | None = None,
    margin: Margin | None = None,
    units_of: UnitsOf = units_of,
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
    units_of
        Returns the units that the claims rest on.
    """
    from pandas import DataFrame

    usable, kept = group.usable, group.complete
    values = group.values[:, usable]
    units = units_of(group, values, kept)
    values = values[kept]
    none = np.full(values.shape[1], np.nan)
    many = len(values) > 0
    mean, low, high = (none, none, none) if not many else _numbers(units, ratio)

    def spread(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        full = np.full(usable.shape, np.nan)
        full[usable] = numbers
        return full

    ranks = DataFrame(sign_of(end) * values).rank(axis=1)
    place = group.methods.index(against) if against in group.methods else None
    return Summary(
        group,
        units,
        end,
        ratio,
        mean=spread(mean),
        low=spread(low),
        high=spread(high),
        arithmetic=spread(units.typical(ratio=False) if many else none),
        median=spread(np.median(values, axis=0) if many else none),
        rank=spread(ranks.mean().to_numpy()),
        blocks=np.where(usable, len(values), 0),
        against=place,
        margin=margin,
    )


def _numbers(
    units: Units, ratio: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the numbers of methods, and the ends of their intervals over the units."""
    size = np.abs(units.recordings).mean(axis=0)
    mean = settled(units.typical(ratio), size)
    if units.speech == "nothing":
        return mean, np.full(mean.shape, np.nan), np.full(mean.shape, np.nan)
    low, high = mean_interval(units.numbers(ratio), units.parts)
    return (mean, np.exp(low), np.exp(high)) if ratio else (mean, low, high)


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
    if np.nanmin(values) < 0.0:
        return False
    every = [units_of(group, values, kept)]
    if every[0].kind == "draws":
        every.append(segments_of(group, values, kept))
    return all(units.positive for units in every)
