"""From the statistics of groups, by every rule, to their verdicts."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from nodegraph_compare.blocks import Group
from nodegraph_compare.inference import LEVEL, contrasts
from nodegraph_compare.question import sign_of
from nodegraph_compare.table.summary import Summary, summarise
from nodegraph_compare.units import segments_of
from nodegraph_compare.verdict import COMMON, WORST, Paired, Rule, Variation, Verdict, scope_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from nodegraph import Declared, Label
    from nodegraph_compare.comparison import Comparison

AnyRule = Rule | Literal["main", "without suspects", "next minutes"]
ByRule = dict[AnyRule, Summary]

_OTHERS: tuple[Rule, ...] = (COMMON, WORST)
_MOST_BLOCKS = 0.55
"""Share of the blocks in which another method than the best is better for a remark."""


def by_rules(
    group: Group,
    plain: Group | None,
    fallback: Label | None,
    of: Callable[..., Summary],
) -> ByRule:
    """Return the statistics of a group by each rule: ``main``, and others beside it.

    Parameters
    ----------
    group
        As it is.
    plain
        Without its suspect blocks; None where there are none.
    fallback
        The method whose value stands where another has none; then the blocks that all methods
        have, and the worst value of the block in its place, are the other rules.
    of
        Returns the statistics of a group, over its units or others.
    """
    filled = group if fallback is None else group.filled(fallback)
    main = of(filled)
    rules: ByRule = {"main": main}
    if main.units.kind == "draws":
        minutes = of(filled, units_of=segments_of)
        if minutes.units.placed:
            rules["next minutes"] = minutes
    if fallback in group.methods:
        rules[COMMON] = of(group)
        rules[WORST] = of(group.with_worst(main.end))
    if plain is not None:
        plain = plain if fallback is None else plain.filled(fallback)
        rules["without suspects"] = of(plain)
    return rules


def verdict_of(
    rules: ByRule,
    comparison: Comparison,
    *,
    suspects: tuple[str, ...] = (),
    beside: Mapping[str, NDArray[np.float64]] | None = None,
) -> Verdict:
    """Return the verdict on a group.

    Parameters
    ----------
    rules
        Its statistics by each rule.
    comparison
        What is compared.
    suspects
        Its blocks whose truth is suspect.
    beside
        Means over units of what is shown next to the metric.
    """
    plain, minutes = rules.get("without suspects"), rules.get("next minutes")
    return replace(
        _alone(rules["main"], comparison),
        beside=beside or {},
        suspects=suspects,
        by_rule={rule: _alone(rules[rule], comparison) for rule in _OTHERS if rule in rules},
        without_suspects=None if plain is None else _alone(plain, comparison),
        next_minutes=None if minutes is None else _alone(minutes, comparison),
    )


def _alone(summary: Summary, comparison: Comparison) -> Verdict:
    """Return the verdict by one rule."""
    group, count = summary.group, len(comparison.methods)
    at = np.array([comparison.methods.index(method) for method in group.methods], dtype=np.intp)

    def spread(values: NDArray[Any], nothing: float | bool = np.nan) -> NDArray[Any]:
        full = np.full(count, nothing, dtype=values.dtype)
        full[at] = values
        return full

    def places(where: NDArray[np.bool_]) -> tuple[int, ...]:
        return tuple(sorted(at[where].tolist()))

    def paired(among: Paired | None) -> Paired | None:
        if among is None:
            return None
        arrays = {each.name: getattr(among, each.name) for each in fields(among)}
        reference = arrays.pop("reference")
        alone = spread(arrays.pop("alone"), False)
        numbers = {name: spread(values) for name, values in arrays.items()}
        return Paired(int(at[reference]), alone=alone, **numbers)

    is_sequence = comparison.is_sequence
    taken = np.array(group.taken or [0] * len(at), dtype=np.int64)
    return Verdict(
        labels=group.labels,
        better=summary.end,
        ratio=summary.ratio,
        scope=scope_of(summary.units, comparison.question, comparison.blocks),
        ranked=tuple(at[summary.ranked].tolist()),
        best=places(summary.bests),
        mean=spread(summary.mean),
        low=spread(np.clip(summary.low, *comparison.limits)),
        high=spread(np.clip(summary.high, *comparison.limits)),
        arithmetic=spread(summary.arithmetic),
        median=spread(summary.median),
        rank=spread(summary.rank),
        blocks=spread(summary.blocks.astype(np.int64), 0),
        of_blocks=len(group.values),
        lacking=spread(np.isnan(group.values).sum(axis=0).astype(np.int64), 0),
        taken=spread(taken, 0),
        missing=spread(group.missing),
        refused=spread(group.refused),
        to_best=paired(summary.to_best),
        to_baseline=None if summary.against is None else paired(summary.paired),
        baseline=None if summary.against is None else int(at[summary.against]),
        margin=np.nan if summary.margin is None else summary.margin.size,
        p_of_step=spread(summary.p_of_step) if is_sequence else np.full(count, np.nan),
        usual=_usual(summary, at),
    )


def _usual(summary: Summary, at: NDArray[np.intp]) -> tuple[int, float] | None:
    """Return the method of the best mean rank and how often it beats the best, if it often does."""
    if summary.best is None or not summary.blocks.any():
        return None
    first = int(np.nanargmin(summary.rank))
    values = summary.group.values[summary.group.complete]
    better = sign_of(summary.end) * (values[:, [first]] - values[:, summary.bests]) < 0.0
    share = float(better.mean())
    if summary.bests[first] or share < _MOST_BLOCKS:
        return None
    return int(at[first]), share


def over_groups(groups: Sequence[ByRule]) -> ByRule | None:
    """Return the statistics over all groups, by each rule for missing blocks.

    With ``Y[c, m]`` the logarithm of the mean of method m in cluster c, averaged over groups,
    methods are compared as within a group: there is one comparison, which needs no factor for the
    number of groups. A method that lacks numbers in some group does not take part.

    Parameters
    ----------
    groups
        Of each group, by each rule.

    Returns
    -------
    mapping of rule to Summary, or None
        None for a single group, and where groups differ in their clusters or have no ratios.
    """
    combined: ByRule = {}
    every: tuple[AnyRule, ...] = ("main", *_OTHERS)
    for rule in every:
        of_rule = [rules[rule] for rules in groups if rule in rules]
        if not of_rule:
            continue
        over_all = _combined(of_rule) if len(of_rule) == len(groups) else None
        if over_all is None:
            return None
        combined[rule] = over_all
    return combined or None


def _combined(summaries: Sequence[Summary]) -> Summary | None:
    if len(summaries) < 2 or not all(summary.ratio for summary in summaries):
        return None
    first = summaries[0]
    clusters = [np.unique(s.group.cluster[s.group.complete]) for s in summaries]
    if not all(s.units.kind == "clusters" for s in summaries) or not all(
        np.array_equal(each, clusters[0]) for each in clusters
    ):
        return None
    common = set.intersection(*({*_usable(summary)} for summary in summaries))
    methods = tuple(method for method in _usable(first) if method in common)
    if len(methods) < 2:
        return None
    places = [[_usable(s).index(method) for method in methods] for s in summaries]
    logs = [np.log(s.units.means[:, at]) for s, at in zip(summaries, places, strict=True)]
    columns = [[s.group.methods.index(method) for method in methods] for s in summaries]
    lost = list(zip(summaries, columns, strict=True))
    count = len(clusters[0])
    nowhere = np.full(count, np.nan)
    group = Group(
        labels=(),
        methods=methods,
        values=np.exp(np.mean(logs, axis=0)),
        missing=np.mean([s.group.missing[at] for s, at in lost], axis=0),
        refused=np.mean([s.group.refused[at] for s, at in lost], axis=0),
        # each cluster is a block of its own
        cluster=np.arange(count),
        draw=np.zeros(count, dtype=np.intp),
        draws=1,
        start=nowhere,
        frames=nowhere,
        span=nowhere,
        correlation=nowhere,
        rows=np.arange(count),
        block=np.arange(count),
    )
    against = None if first.against is None else first.group.methods[first.against]
    overall = summarise(group, first.end, ratio=True, against=against, margin=first.margin)
    return replace(
        overall,
        blocks=np.array([_distinct(lost, at) for at in range(len(methods))], dtype=np.intp),
        median=np.full(len(methods), np.nan),
    )


def variations(
    every: Sequence[ByRule], comparison: Comparison, declared: Mapping[Label, Declared]
) -> tuple[Variation, ...]:
    """Return what the choices between two ways of every method do.

    Such a choice is an axis of two labels that the settings of methods take. A method is better one
    way if it is so in every group, by every rule for missing blocks, in a paired test each: a claim
    on all groups needs no adjustment.

    Parameters
    ----------
    every
        The statistics of each group, by each rule.
    comparison, declared
        What is compared, and what the methods declare.
    """
    result = []
    for at, axis in enumerate(comparison.question.within):
        labels = list(dict.fromkeys(rules["main"].group.labels[at] for rules in every))
        if len(labels) != 2 or not any(axis in each.get("axes", ()) for each in declared.values()):
            continue
        pairs = _pairs_along(every, at)
        sides = {
            method: [_side(first, second, method) for first, second in pairs]
            for method in comparison.methods
        }
        known = {
            place: [side for side in sides[method] if side is not None]
            for place, method in enumerate(comparison.methods)
            if pairs and None not in sides[method]
        }
        higher = sum(all(side > 0 for side in each) for each in known.values())
        lower = sum(all(side < 0 for side in each) for each in known.values())
        # by the second label, unless more are better by the first
        sign = -1 if higher > lower else 1
        better = tuple(at for at, each in known.items() if all(sign * side < 0 for side in each))
        worse = tuple(at for at, each in known.items() if any(sign * side > 0 for side in each))
        label, other = labels[::-1] if sign > 0 else labels
        if better:
            result.append(Variation(axis, label, other, len(known), better, worse))
    return tuple(result)


def _pairs_along(every: Sequence[ByRule], at: int) -> list[tuple[ByRule, ByRule]]:
    """Return the groups that differ in one label alone, the first label first."""
    pairs: dict[tuple[Label, ...], list[ByRule]] = {}
    for rules in every:
        labels = rules["main"].group.labels
        pairs.setdefault((*labels[:at], *labels[at + 1 :]), []).append(rules)
    return [(pair[0], pair[1]) for pair in pairs.values() if len(pair) == 2]


def _side(first: ByRule, second: ByRule, method: Label) -> int | None:
    """Return -1 where a method is clearly better in the second of two groups, 1 where worse.

    0 where neither is clear, and None where it has no number in one of them.
    """
    rules = [rule for rule in ("main", COMMON, WORST) if rule in first and rule in second]
    sides = {_side_by(first[rule], second[rule], method) for rule in rules}
    if None in sides:
        return None
    return sides.pop() if len(sides) == 1 else 0


def _side_by(first: Summary, second: Summary, method: Label) -> int | None:
    columns = []
    for summary in (first, second):
        usable = _usable(summary)
        if method not in usable or not summary.judged:
            return None
        columns.append(summary.units.numbers(summary.ratio)[:, usable.index(method)])
    if not np.array_equal(_unit_names(first), _unit_names(second)):
        return None
    y = sign_of(first.end) * np.stack(columns, axis=1)
    if np.array_equal(y[:, 0], y[:, 1]):
        return 0
    result = contrasts(y, 0, first.units.parts, in_steps=False)
    return int(np.sign(result.mean[1])) if result.p[1] <= LEVEL else 0


def _unit_names(summary: Summary) -> NDArray[np.intp]:
    units, group = summary.units, summary.group
    return np.unique(group.cluster[group.complete]) if units.kind == "clusters" else units.strata


def _distinct(summaries: Sequence[tuple[Summary, Sequence[int]]], at: int) -> int:
    """Return the number of blocks of a method over all groups, the same results counted once."""
    values = [s.group.values[s.group.complete, columns[at]] for s, columns in summaries]
    return sum({each.tobytes(): len(each) for each in values}.values())


def _usable(summary: Summary) -> tuple[Label, ...]:
    pairs = zip(summary.group.methods, summary.group.usable, strict=True)
    return tuple(method for method, usable in pairs if usable)
