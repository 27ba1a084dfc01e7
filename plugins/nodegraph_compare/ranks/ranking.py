"""Ranks of methods within blocks, and the tests of them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph import listed
from nodegraph_compare.inference import LEVEL, range_quantile
from nodegraph_compare.question import sign_of
from nodegraph_compare.ranks.signed_rank import holm, rank_biserial, signed_rank
from nodegraph_compare.studentised_range import survival
from nodegraph_compare.ties import apart
from nodegraph_compare.units import units_of
from nodegraph_compare.verdict import COMMON, WORST
from nodegraph_compare.words import rule_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.units import Units
    from nodegraph_compare.verdict import Rule
    from nodegraph_tables import BetterEnd

PairTest = Literal["nemenyi", "wilcoxon_holm"]


@dataclass(frozen=True)
class Ranking:
    """Ranks of the K usable methods of a group within its N units.

    Attributes
    ----------
    group : Group
    methods : tuple of K labels
    units : Units
    values : (N, K) array of float64
        The means of the units; the complete blocks, untested, where there are no units.
    ranks : (K,) array of float64
        Mean over the units; 1 is the best in every unit. NaN without one.
    overall : Overall
    pairs : Pairs
    by_rule : mapping of str to Ranking
        The same by the other rules for missing blocks, `COMMON` and `WORST`.
    """

    group: Group
    methods: tuple[Label, ...]
    units: Units
    values: NDArray[np.float64]
    ranks: NDArray[np.float64]
    overall: Overall
    pairs: Pairs
    by_rule: Mapping[Rule, Ranking] = field(default_factory=dict)

    @property
    def first(self) -> NDArray[np.bool_]:
        """(K,), True for the lowest mean rank."""
        return np.asarray(self.ranks == self.ranks.min(initial=np.inf))

    @property
    def first_names(self) -> str:
        """The methods with the lowest mean rank."""
        return listed([str(self.methods[place]) for place in np.flatnonzero(self.first)])

    @property
    def differ(self) -> bool:
        """Whether the methods differ by more than chance."""
        if len(self.methods) == 2:
            return bool(self.pairs.p[0] < LEVEL)
        return bool(self.overall.p_f < LEVEL)

    @property
    def apart(self) -> NDArray[np.bool_]:
        """(P,), True for pairs that are apart by every rule for missing blocks."""
        rules = [each.pairs.p < LEVEL for each in (self, *self.by_rule.values())]
        return np.asarray(np.logical_and.reduce(rules))

    def objections(self, blocks: str) -> str:
        """Return what the other rules say instead; empty where they say the same.

        Parameters
        ----------
        blocks
            What several blocks are called.
        """
        return " and ".join(
            f"{rule_text(rule, blocks)} {text}"
            for rule, other in self.by_rule.items()
            if self.differ and (text := self._instead(other))
        )

    def _instead(self, other: Ranking) -> str:
        if not len(other.values):
            return "nothing can be ranked"
        if other.first_names != self.first_names:
            verb = "has" if np.count_nonzero(other.first) == 1 else "share"
            return f"{other.first_names} {verb} the lowest mean rank"
        return "" if other.differ else "the methods are not told apart"


@dataclass(frozen=True)
class Overall:
    """Friedman's test of three methods or more; NaN for fewer.

    Attributes
    ----------
    chi2, p, f, p_f : float
        Friedman's statistic and Iman and Davenport's, with their p.
    w : float
        Kendall's coefficient of concordance: 1 where all blocks rank alike, 0 where none agree.
    critical : float
        Difference of mean ranks from which Nemenyi's test calls two methods apart.
    """

    chi2: float
    p: float
    f: float
    p_f: float
    w: float
    critical: float


@dataclass(frozen=True)
class Pairs:
    """The pairs of methods, P = K (K - 1) / 2.

    Attributes
    ----------
    first, second : (P,) arrays of int
        Places in the methods.
    p : (P,) array of float64
        Adjusted for the number of pairs.
    effect : (P,) array of float64
        Matched-pairs rank-biserial correlation: 1 where the first is better in every block.
    """

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    p: NDArray[np.float64]
    effect: NDArray[np.float64]


def rank_by_rules(group: Group, fallback: Label | None, end: BetterEnd, test: PairTest) -> Ranking:
    """Return the ranking of a group with a fallback, and those by the other rules beside it.

    Parameters
    ----------
    group
        As it was scored.
    fallback
        The method whose value stands where another has none.
    end, test
        See `rank`.
    """
    if fallback not in group.methods or group.complete.all():
        return rank(group, end, test)
    others: dict[Rule, Ranking] = {
        COMMON: rank(group, end, test),
        WORST: rank(group.with_worst(end), end, test),
    }
    return replace(rank(group.filled(fallback), end, test), by_rule=others)


def rank(group: Group, end: BetterEnd, test: PairTest) -> Ranking:
    """Return the ranking of a group's usable methods.

    Parameters
    ----------
    group
        The values of its methods in its blocks.
    end
        Which end of the metric is better; of ``none``, rank 1 is the lowest value.
    test
        Of the pairs.
    """
    from pandas import DataFrame

    usable = group.usable
    units = units_of(group, group.values[:, usable], group.complete)
    values = units.means if units.count else group.values[group.complete][:, usable]
    methods = tuple(name for name, has in zip(group.methods, usable, strict=True) if has)
    within = DataFrame(sign_of(end) * values).rank(axis=1).to_numpy()
    ranks = within.mean(axis=0) if len(values) else np.full(len(methods), np.nan)
    tested = units.judged
    pairs = _pairs(sign_of(end) * values, ranks, test if tested else None)
    overall = _overall(within if tested else within[:0])
    return Ranking(group, methods, units, values, ranks, overall, pairs)


def critical_difference(blocks: int, methods: int) -> float:
    """Return Nemenyi's critical difference of mean ranks at 5 % (Demsar 2006, section 3.2.2).

    ``q / sqrt(2) sqrt(k (k + 1) / (6 N))`` with the studentised range q of k normal means.
    """
    return range_quantile(methods, np.inf) * _unit(blocks, methods)


def runs(ranking: Ranking) -> list[tuple[int, int]]:
    """Return the first and last places, by mean rank, of methods of which no two are apart.

    Only runs of two or more, none of them within another: the bars of the diagram.
    """
    order = np.argsort(ranking.ranks, kind="stable")
    count = len(order)
    apart = np.zeros((count, count), dtype=bool)
    pairs = ranking.pairs
    apart[pairs.first, pairs.second] = apart[pairs.second, pairs.first] = pairs.p < LEVEL
    apart = apart[np.ix_(order, order)]
    places: list[tuple[int, int]] = []
    for first in range(count):
        last = first
        while last + 1 < count and not apart[first : last + 1, last + 1].any():
            last += 1
        if last > first and (not places or last > places[-1][1]):
            places.append((first, last))
    return places


def _overall(within: NDArray[np.float64]) -> Overall:
    """Return Friedman's test of all methods, corrected for ties, with Kendall's W.

    With ``S`` the sum of squared deviations of all ranks from their mean ``(k + 1) / 2``, which
    is ``N k (k^2 - 1) / 12`` where nothing is tied,
    ``chi2 = N (k - 1) N sum((R_j - (k + 1) / 2)^2) / S`` and ``W = chi2 / (N (k - 1))``;
    ``F = (N - 1) chi2 / (N (k - 1) - chi2)`` with ``k - 1`` and ``(k - 1)(N - 1)`` degrees of
    freedom (Iman & Davenport 1980). Where all methods tie in every block, chi2 is 0.
    """
    from scipy.special import chdtrc, fdtrc

    blocks, methods = within.shape
    if methods < 3 or blocks < 2:
        return Overall(*[np.nan] * 6)
    middle = (methods + 1) / 2
    total = float(np.square(within - middle).sum())
    # sums of ranks are exact, means are not: blocks that all rank alike must come out as 1
    between = float(np.square((within - middle).sum(axis=0)).sum())
    w = between / (blocks * total) if total else 0.0
    most = blocks * (methods - 1)
    chi2 = most * w
    f = (blocks - 1) * w / (1 - w) if w < 1.0 else np.inf
    return Overall(
        chi2=chi2,
        p=float(chdtrc(methods - 1, chi2)),
        f=f,
        p_f=float(fdtrc(methods - 1, (methods - 1) * (blocks - 1), f)),
        w=w,
        critical=critical_difference(blocks, methods),
    )


def _pairs(signed: NDArray[np.float64], ranks: NDArray[np.float64], test: PairTest | None) -> Pairs:
    blocks, methods = signed.shape
    first, second = np.triu_indices(methods, 1)
    if not blocks or not len(first):
        nothing = np.full(len(first), np.nan)
        return Pairs(first, second, nothing, nothing)
    differences = apart(signed[:, second], signed[:, first])
    if test is None:
        p = np.full(len(first), np.nan)
    elif test == "nemenyi" and methods > 2:
        p = _nemenyi(np.abs(ranks[first] - ranks[second]), blocks, methods)
    else:
        p = holm(signed_rank(differences))
    return Pairs(first, second, p, rank_biserial(differences))


def _nemenyi(differences: NDArray[np.float64], blocks: int, methods: int) -> NDArray[np.float64]:
    sizes, place = np.unique(differences, return_inverse=True)
    ratio = sizes / _unit(blocks, methods) * np.sqrt(2)
    return np.asarray(survival(ratio, methods, np.inf)[place])


def _unit(blocks: int, methods: int) -> float:
    """Return the standard error of the difference of two mean ranks."""
    return float(np.sqrt(methods * (methods + 1) / (6 * blocks)))
