"""Verdicts on methods as data, of which `nodegraph_compare.answer` makes sentences and cards.

Places of methods are those of `Verdicts.methods`. Arrays have a number for each of these K methods;
NaN stands for a method without any number.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from nodegraph import Value
from nodegraph_compare.inference import LEVEL
from nodegraph_compare.units import speech_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.question import Margin, Question
    from nodegraph_compare.recordings import Recordings
    from nodegraph_compare.units import Kind, Shortage, Speech, Units
    from nodegraph_tables import BetterEnd

    Numbers = NDArray[np.float64]

Rule = Literal["common blocks", "worst of block"]

_FACES = ("recording", "actor")
"""What a made face is called in a graph."""

_DOUBTFUL = 0.10

Mark = Literal["best", "tied"]

COMMON: Final = "common blocks"
WORST: Final = "worst of block"


@dataclass(frozen=True, kw_only=True)
class Scope(Value):
    """The scope of a result: so many independent units of a kind.

    Attributes
    ----------
    kind : str
        See `nodegraph_compare.units.Units`.
    clusters : int
        Number of recordings, or other clusters; 1 without any.
    units : int
        Number of units.
    count : int
        The same less those that are spent on further recordings.
    fewest : int
        Blocks in the unit with fewest.
    shortage : Shortage or None
        Why there are no units.
    several : str
        What several clusters are called: ``actors``.
    blocks : str
        What several blocks are called: ``gaps``; empty where a block is a cluster.
    drawn : str
        The axis of repetitions on the same data; empty where there is none.
    """

    kind: Kind
    clusters: int
    units: int
    count: int
    fewest: int
    shortage: Shortage | None
    several: str
    blocks: str
    drawn: str

    @property
    def speech(self) -> Speech:
        """The kind of claim that so many units allow."""
        return speech_of(self.kind, self.count)

    @property
    def judged(self) -> bool:
        """Whether there are units enough for p and a verdict."""
        return self.speech in ("provisional", "settled")


def clusters_name(question: Question) -> str:
    """Return what several clusters are called: ``actors``; empty without any."""
    names = [name.rpartition(".")[2] for name in question.clusters]
    if len(names) > 1:
        return f"combinations of {' and '.join(names)}"
    if names and question.synthetic:
        return "synthetic faces" if names[0] in _FACES else f"synthetic {names[0]}s"
    return f"{names[0]}s" if names else ""


def scope_of(units: Units, question: Question, blocks: str) -> Scope:
    """Return what a result holds for.

    Parameters
    ----------
    units, question
        Of the comparison.
    blocks
        What several blocks are called.
    """
    names, several = question.clusters, clusters_name(question)
    are_clusters = bool(names) and set(question.blocks) <= set(names)
    return Scope(
        kind=units.kind,
        clusters=units.clusters,
        units=len(units.means),
        count=units.count,
        fewest=units.fewest,
        shortage=units.shortage,
        several=several,
        blocks="" if are_clusters else blocks,
        drawn=question.drawn[0] if len(question.drawn) == 1 else "",
    )


@dataclass(frozen=True, eq=False)
class Paired(Value):
    """Differences of each method to one of them, for which there is no number.

    Attributes
    ----------
    reference : int
    value, low, high : (K,) arrays of float64
        Ratio, or difference, of mean errors, and the ends of its interval.
    difference, difference_low, difference_high : (K,) arrays of float64
        Of the means over units; of ratios, the ends are those of their interval, less 1, times
        the reference's mean.
    p, flips : (K,) arrays of float64
        Of the floored Tukey rule, and of sign flips; NaN for too few units.
    effect : (K,) array of float64
        Hedges' g, positive where the method is worse.
    wins, losses : (K,) arrays of float64
        Units in which the method is better, and worse.
    margin : (K,) array of float64
        The smallest ratio, or difference, within which it is shown to be equal.
    alone : (K,) array of bool
        Told apart by the t-test of the two by themselves, as if there were no other methods.
    """

    reference: int
    value: Numbers
    low: Numbers
    high: Numbers
    difference: Numbers
    difference_low: Numbers
    difference_high: Numbers
    p: Numbers
    flips: Numbers
    effect: Numbers
    wins: Numbers
    losses: Numbers
    margin: Numbers
    alone: NDArray[np.bool_]

    @property
    def doubtful(self) -> NDArray[np.bool_]:
        """(K,), whether the t-test alone tells them apart, and sign flips do not."""
        return self.alone & (self.flips > _DOUBTFUL)

    @property
    def apart(self) -> NDArray[np.bool_]:
        """(K,), whether p is at most 5 %."""
        return np.asarray(self.p <= LEVEL)


@dataclass(frozen=True, eq=False, kw_only=True)
class Verdict(Value):
    """The verdict on the methods of one group, and the numbers that it rests on.

    Attributes
    ----------
    labels : tuple of label
        Of `Verdicts.within`; none for the verdict over all groups.
    better : str
        Which end of the metric is better.
    ratio : bool
        Whether methods are compared by ratios, not by differences.
    scope : Scope
    ranked : tuple of int
        The methods that the group has, from the best to the worst, without any number last; in the
        order of the graph where neither end is better.
    best : tuple of int
        The methods with the best mean.
    mean, low, high : (K,) arrays of float64
        The number that decides, with its interval over the units: over clusters the geometric
        mean, the error of a typical one, or, where methods are compared by differences, the
        arithmetic mean.
    arithmetic, median, rank : (K,) arrays of float64
        Mean over clusters, median over blocks, and mean rank within blocks.
    blocks : (K,) array of int
        Number of blocks used; 0 for a method without any number.
    of_blocks : int
        Number of blocks that there are.
    lacking, taken : (K,) arrays of int
        Blocks in which a method has no number, and in which that of the fallback stands instead.
    missing, refused : (K,) arrays of float64
        Share of the method's rows without a number, and of its combinations that were refused or
        failed.
    to_best, to_baseline : Paired or None
        None where there is no best, no baseline in the group, or too few units to compare.
    baseline : int or None
        The method that the others are compared to in place of the best.
    margin : float
        Within which methods count as equal; NaN where none is declared.
    p_of_step : (K,) array of float64
        Of the difference to the one before, where methods follow one another.
    usual : tuple of (int, float) or None
        The method of the best mean rank that is better than the best mean in so large a share of
        blocks, where it is another one.
    beside : mapping of str to (K,) array of float64
        Means over units of what is shown next to the metric.
    suspects : tuple of str
        Blocks whose truth is suspect.
    by_rule : mapping of str to Verdict
        The same by other rules for missing blocks, `COMMON` and `WORST`.
    without_suspects : Verdict or None
        The same without suspect blocks; None where there are none.
    next_minutes : Verdict or None
        The same over segments of the recordings, where it rests on repetitions on these.
    """

    labels: tuple[Label, ...]
    better: BetterEnd
    ratio: bool
    scope: Scope
    ranked: tuple[int, ...]
    best: tuple[int, ...]
    mean: Numbers
    low: Numbers
    high: Numbers
    arithmetic: Numbers
    median: Numbers
    rank: Numbers
    blocks: NDArray[np.int64]
    of_blocks: int
    lacking: NDArray[np.int64]
    taken: NDArray[np.int64]
    missing: Numbers
    refused: Numbers
    to_best: Paired | None
    to_baseline: Paired | None
    baseline: int | None
    margin: float
    p_of_step: Numbers
    usual: tuple[int, float] | None
    beside: Mapping[str, Numbers] = field(default_factory=dict)
    suspects: tuple[str, ...] = ()
    by_rule: Mapping[Rule, Verdict] = field(default_factory=dict)
    without_suspects: Verdict | None = None
    next_minutes: Verdict | None = None

    @property
    def known(self) -> list[int]:
        """The methods with a mean."""
        return _places(np.isfinite(self.mean))

    @property
    def marks(self) -> Mapping[int, Mark]:
        """The methods that every table and picture marks: none where nothing is told apart.

        Where others may be as good as those with the best mean, these are marked alike.
        """
        if not self.behind:
            return {}
        return dict.fromkeys((*self.best, *self.tied), "tied" if self.tied else "best")

    @property
    def told(self) -> bool:
        """Whether a verdict tells methods apart, or all of them are equal."""
        return self.stands and (bool(self.behind) or len(self.best) == len(self.known))

    def marked(self, mark: Mark) -> list[int]:
        """Return the methods with a mark, in their order."""
        return sorted(place for place, of in self.marks.items() if of == mark)

    @property
    def not_compared(self) -> list[int]:
        """The methods of the group that have no number."""
        return [place for place in self.ranked if not self.blocks[place]]

    @property
    def judged(self) -> bool:
        """Whether there are units enough for p and a verdict."""
        return self.scope.judged

    @property
    def objections(self) -> Mapping[Rule, Verdict]:
        """The other rules for missing blocks by which other methods are the best."""
        return {
            rule: other
            for rule, other in self.by_rule.items()
            if self.best and other.best != self.best
        }

    @property
    def stands(self) -> bool:
        """Whether there is a verdict: units enough, a better end, and one best by every rule."""
        return self.judged and bool(self.best) and not self.objections

    @property
    def suspects_decide(self) -> bool:
        """Whether suspect blocks make the best out of a method that is clearly behind otherwise."""
        other = self.without_suspects
        if other is None:
            return False
        return bool({*other.best} & {*self.behind} or {*self.best} & {*other.behind})

    @property
    def suspects_matter(self) -> bool:
        """Whether other methods are the best without suspect blocks, or clearly behind it."""
        other = self.without_suspects
        return other is not None and (other.best, other.worse_than_best) != (
            self.best,
            self.worse_than_best,
        )

    @property
    def worse_than_best(self) -> list[int]:
        """The methods that are clearly worse than the best, by this rule for missing blocks."""
        if self.to_best is None:
            return []
        return [place for place in _places(self.to_best.apart) if place not in self.best]

    @cached_property
    def behind(self) -> list[int]:
        """The methods that are clearly worse than the best by every rule, if there is a verdict.

        None where methods follow one another: there each is judged by what it changes.
        """
        if not self.stands or np.isfinite(self.p_of_step).any():
            return []
        others = [other.worse_than_best for other in self.by_rule.values()]
        return [p for p in self.worse_than_best if all(p in other for other in others)]

    @property
    def tied(self) -> list[int]:
        """The methods that are not certain to be worse than the best, if there is a verdict."""
        if not self.stands:
            return []
        behind = self.behind
        return [p for p in _places(self.blocks > 0) if p not in self.best and p not in behind]

    @property
    def paired(self) -> Paired | None:
        """Differences of each method to the baseline; to the best one if there is none."""
        return self.to_best if self.baseline is None else self.to_baseline

    @property
    def equal(self) -> list[int]:
        """The methods shown by every rule to be within the margin of what they are compared to."""
        every = [self, *self.by_rule.values()]
        if not all(each.judged and each.paired is not None for each in every):
            return []
        within = [each.paired.margin <= each.margin for each in every if each.paired is not None]
        return _places(np.logical_and.reduce(within))

    def beyond_baseline(self, side: Literal["lower", "higher"]) -> list[int]:
        """Return the methods that are clearly lower, or higher, than the baseline by every rule."""
        if self.baseline is None:
            return []
        sign = 1.0 if side == "higher" else -1.0
        sides = []
        for each in (self, *self.by_rule.values()):
            if each.paired is None:
                return []
            middle = 1.0 if each.ratio else 0.0
            sides.append(each.paired.apart & (sign * (each.paired.value - middle) > 0.0))
        return _places(np.logical_and.reduce(sides))

    def distance(self, place: int) -> float:
        """Return how far a method is from the best: by a ratio of at least 1, or a difference."""
        if place in self.best or self.to_best is None:
            return 1.0 if self.ratio else 0.0
        value = float(self.to_best.value[place])
        if not self.ratio:
            return abs(value)
        return 1.0 / value if self.better == "higher" else value

    def to_best_of(self, place: int) -> float:
        """Return the difference of a method's mean to that of the best; NaN for the best."""
        return np.nan if self.to_best is None else float(self.to_best.difference[place])


@dataclass(frozen=True)
class Variation(Value):
    """A choice between two ways of every method, such as gaps whose ends are met or are not.

    Attributes
    ----------
    axis : str
        Of `Verdicts.within`.
    label, other : label
        The two ways; by `label` most methods are better.
    methods : int
        How many have numbers both ways.
    better, worse : tuple of int
        Those that are clearly better by `label` in every group, and clearly worse in some.
    """

    axis: str
    label: Label
    other: Label
    methods: int
    better: tuple[int, ...]
    worse: tuple[int, ...]


@dataclass(frozen=True)
class Metric(Value):
    """A column of numbers.

    Attributes
    ----------
    name, unit : str
    better : str
        Which end of it is better.
    ratio : bool
        Whether its mean over clusters is geometric.
    """

    name: str
    unit: str
    better: BetterEnd
    ratio: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Verdicts(Value):
    """The verdicts on K methods by one number, group by group.

    Attributes
    ----------
    metric : Metric
        What is compared.
    beside : tuple of Metric
        What is shown next to it.
    compare : str
        What the methods are labels of; empty where nothing is compared.
    is_sequence : bool
        Whether they follow one another, such as the steps of a chain, in this order.
    within : tuple of str
        What the groups are combinations of.
    blocks, units : str
        What several blocks, and several independent units, are called: ``gaps``, ``actors``.
    methods : tuple of label
    baseline : label or None
        The method that every other is compared to.
    fallback : label or None
        The method whose value stands where another has none.
    margin : Margin or None
        Within which methods count as equal.
    adapted : tuple of int
        Methods that differ from what was published.
    ahead : tuple of int
        Methods that look at the whole take.
    recordings : Recordings
        Behind the numbers.
    axis_units : tuple of str
        Of the labels of `within`; empty for those without.
    variations : tuple of Variation
    groups : tuple of Verdict
    overall : Verdict or None
        Over all groups, where these can be taken together.
    """

    metric: Metric
    beside: tuple[Metric, ...]
    compare: str
    is_sequence: bool
    within: tuple[str, ...]
    blocks: str
    units: str
    methods: tuple[Label, ...]
    baseline: Label | None
    fallback: Label | None
    margin: Margin | None
    adapted: tuple[int, ...]
    ahead: tuple[int, ...]
    recordings: Recordings
    axis_units: tuple[str, ...]
    variations: tuple[Variation, ...]
    groups: tuple[Verdict, ...]
    overall: Verdict | None

    @property
    def ratio(self) -> bool:
        """Whether methods are compared by ratios, not by differences."""
        return all(group.ratio for group in self.groups)

    @property
    def best_over_all(self) -> int | None:
        """The method with the best mean over all groups, if the verdict on these names one.

        None where some groups have further methods.
        """
        of_all = self.overall
        if of_all is None or self.is_sequence or not of_all.marks or len(of_all.best) > 1:
            return None
        if any(group.known != of_all.known for group in self.groups):
            return None
        return of_all.best[0]

    @property
    def for_all(self) -> int | None:
        """The method to take whichever the group is, if verdicts speak for one.

        It is the best over all groups; or else, of those that are clearly behind in the fewest, and
        in less than half of them, the least far behind at its worst.
        """
        groups = self.groups
        told = any(group.told for group in groups) and all(group.stands for group in groups)
        if self.best_over_all is not None or self.is_sequence or len(groups) < 2 or not told:
            return self.best_over_all
        first = next(iter(self.least_behind), None)
        if first is None or 2 * self.behind_in(first) >= len(groups):
            return None
        # methods of equal errors everywhere leave nothing to choose
        equal = set.intersection(*({*group.best} for group in groups))
        return None if first in equal and len(equal) > 1 else first

    @property
    def least_behind(self) -> list[int]:
        """The methods that every group has, from the one clearly behind in the fewest groups on.

        Of as many groups, the least far behind at its worst is first.
        """
        known = set.intersection(*({*group.known} for group in self.groups))
        far = {place: self.worst_of(place).distance(place) for place in known}
        return sorted(known, key=lambda each: (self.behind_in(each), far[each], each))

    def behind_in(self, place: int) -> int:
        """Return in how many groups a method is clearly behind."""
        return sum(place in group.behind for group in self.groups)

    def worst_of(self, place: int) -> Verdict:
        """Return the group in which a method is farthest from the best."""
        return max(self.groups, key=lambda group: group.distance(place))

    @property
    def every(self) -> tuple[Verdict, ...]:
        """Verdicts of the groups, then that over all of them."""
        return self.groups if self.overall is None else (*self.groups, self.overall)


def _places(where: NDArray[np.bool_]) -> list[int]:
    places: list[int] = np.flatnonzero(where).tolist()
    return places
