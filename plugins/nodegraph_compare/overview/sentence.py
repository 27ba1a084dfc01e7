"""The sentence that answers a comparison: which method is the best, and on what that depends."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import escape

from nodegraph_compare.overview.words import (
    UNCLEAR,
    beside_text,
    both,
    change_text,
    changes,
    either,
    few,
    has_panels,
    in_unit,
    method_names,
    unit_means,
    varying,
    why_none,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.overview.value import GroupOverview, Overview

_MOST_CLAUSES = 6
_MOST_TIED = 2


def sentences(overview: Overview) -> dict[str, str]:
    """Return the answer in a sentence or two, as HTML, for each part of a reader's first view.

    Where cards stand in panels, each panel has an answer of its own, by the label of the panel;
    otherwise there is one, without a label.
    """
    if not has_panels(overview):
        return {"": _sentence(overview)}
    axis = varying(overview)[0]
    parts: dict[str, list[GroupOverview]] = {}
    for group in overview.groups:
        parts.setdefault(f"{overview.within[axis]} {group.labels[axis]}", []).append(group)
    return {
        label: _sentence(replace(overview, groups=tuple(groups))) for label, groups in parts.items()
    }


def _sentence(overview: Overview) -> str:
    known = [group for group in overview.groups if np.isfinite(group.mean).any()]
    metric = overview.metric
    if not known:
        return "No block has a number for every method: nothing can be said."
    if all(np.count_nonzero(np.isfinite(group.mean)) == 1 for group in known):
        return _values(overview, known)
    if metric.better == "none":
        return f"Neither end of {escape(metric.name)} is the better one: what follows describes it."
    stands = [group for group in known if group.stands]
    if not stands:
        reasons = list(dict.fromkeys(why_none(group) for group in known))
        others = len(reasons) - 1
        more = f" (and {others} more reason{'s' * (others > 1)})" if others else ""
        what = (
            f"what each {escape(overview.compare)} does"
            if overview.is_sequence
            else "which is best"
        )
        first = f"The data cannot tell {what}: {escape(reasons[0])}{more}."
        return f"{first}{_extreme_everywhere(overview, known)}{_against(overview, known)}"
    if overview.is_sequence:
        return _steps(overview, stands)
    rest = len(known) - len(stands)
    verb = "have" if rest > 1 else "has"
    without = f" {rest} of {len(known)} groups {verb} no verdict." if rest else ""
    leaders = set.intersection(*(set(group.best) for group in stands))
    if leaders:
        answer = _throughout(overview, stands, sorted(leaders))
    else:
        answer = f"{_depends(overview, stands)}{_compromise(overview, stands)}"
    return f"{answer}{_against(overview, known)}{_besides(overview, stands)}{without}"


def _steps(overview: Overview, stands: Sequence[GroupOverview]) -> str:
    """Return the effect of each step on the mean, with the groups in which it has it."""
    clauses: list[str] = []
    for step in sorted({step for group in stands for step in changes(group)}):
        does: dict[str, list[str]] = {}
        for group in stands:
            if step in (differences := changes(group)):
                before, verb = differences[step]
                by = f"by {change_text(overview, group, before, step)} " * (verb != UNCLEAR)
                where = _where(overview, [group])
                does.setdefault(verb, []).append(f"{by}({where})" if where else by.strip())
        (name,) = method_names(overview, [step])
        metric = "it" if clauses else escape(overview.metric.name)
        parts = [
            f"{verb} {f'{metric} ' * (verb != UNCLEAR)}{both(sizes)}"
            for verb, sizes in sorted(does.items())
        ]
        clauses.append(f"{name} {', '.join(parts)}")
    return f"{'; '.join(clauses)}."


def _besides(overview: Overview, stands: Sequence[GroupOverview]) -> str:
    """Return what else the best methods do."""
    texts = []
    for metric in overview.metrics[1 : 1 + overview.beside]:
        means = [unit_means(group, metric.name)[group.best[0]] for group in stands]
        texts.append(f"{escape(metric.name)} {beside_text([min(means), max(means)], metric)}")
    return f" Of the best: {both(texts)}." if texts else ""


def _extreme_everywhere(overview: Overview, known: Sequence[GroupOverview]) -> str:
    """Return which methods are best in all of several groups."""
    leaders = set.intersection(*(set(group.best) for group in known))
    if not leaders or len(known) < 2:
        return ""
    names = both(method_names(overview, sorted(leaders)))
    verb = "come" if len(leaders) > 1 else "comes"
    return f" {names} {verb} first in all {len(known)} groups."


def _values(overview: Overview, known: Sequence[GroupOverview]) -> str:
    """Return the mean of the only method, or the range of its means."""
    place = int(np.flatnonzero(np.isfinite(known[0].mean))[0])
    means = [float(np.nanmin(group.mean)) for group in known]
    name = overview.methods[place]
    of = f" of {method_names(overview, [place])[0]}" if str(name) else ""
    ends = in_unit(sorted({min(means), max(means)}), overview.metric.unit)
    alone = " There is nothing to compare it to." if of else ""
    return f"The mean {escape(overview.metric.name)}{of} is {ends}.{alone}"


def _throughout(overview: Overview, stands: Sequence[GroupOverview], leaders: Sequence[int]) -> str:
    names = both(method_names(overview, leaders))
    verb = "are" if len(leaders) > 1 else "is"
    where, count = "", len(overview.groups)
    if len(stands) < count:
        where = f" in {len(stands)} of {count} groups"
    elif count > 1:
        where = " throughout"
    if all(np.count_nonzero(np.isfinite(group.mean)) == len(leaders) for group in stands):
        return f"{names} have the same mean {escape(overview.metric.name)}{where}."
    tied = set.intersection(*(set(group.tied) for group in stands))
    if tied:
        first = stands[0]
        order = sorted(tied, key=lambda place: abs(first.difference[place]))
        apart = f", but tied with {few(method_names(overview, order))}."
    elif any(group.tied for group in stands):
        apart = ", in places tied with others."
    else:
        apart = "; every other is clearly behind."
    return f"{names} {verb} best{where}{apart}"


def _depends(overview: Overview, stands: Sequence[GroupOverview]) -> str:
    """Return which method is the best where, the groups with the same best together."""
    by_leader: dict[int, list[GroupOverview]] = {}
    for group in stands:
        by_leader.setdefault(group.best[0], []).append(group)
    axes = both([escape(overview.within[axis]) for axis in varying(overview)])
    if len(by_leader) > _MOST_CLAUSES:
        counts = sorted(by_leader.items(), key=lambda item: -len(item[1]))
        names = [
            f"{method_names(overview, [place])[0]} in {len(groups)}" for place, groups in counts
        ]
        return f"It depends on {axes}: of {len(stands)} groups, {few(names)} have another best."
    clauses = [
        f"{_alternatives(overview, place, groups)} for {_where(overview, groups)}"
        for place, groups in by_leader.items()
    ]
    most = max(by_leader, key=lambda place: len(by_leader[place]))
    several = len(varying(overview)) > 1 and len(by_leader[most]) > 1
    if several and len(by_leader) > 1 and len(stands) == len(overview.groups):
        del clauses[list(by_leader).index(most)]
        clauses.append(f"{_alternatives(overview, most, by_leader[most])} otherwise")
    return f"It depends on {axes}: {'; '.join(clauses)}."


def _alternatives(overview: Overview, leader: int, groups: Sequence[GroupOverview]) -> str:
    """Return the best of groups, with the methods not clearly apart from it in any of them."""
    tied = set.intersection(*({*group.tied, *group.best} for group in groups)) - {leader}
    (name,) = method_names(overview, [leader])
    if len(tied) > _MOST_TIED:
        return f"{name} (tied with {len(tied)} others)"
    if not tied and any(group.tied for group in groups):
        return f"{name} (with ties)"
    order = sorted(tied, key=lambda place: np.nanmax([abs(g.difference[place]) for g in groups]))
    return either([name, *(escape(str(overview.methods[place])) for place in order)])


def _where(overview: Overview, groups: Sequence[GroupOverview]) -> str:
    """Return the labels of groups, by as few of them as tell them from all others."""
    axes = varying(overview)
    if len(axes) == 1:
        return escape(both([str(group.labels[axes[0]]) for group in groups]))
    left = {group.labels for group in groups}
    texts: dict[str, list[str]] = {}
    for axis in reversed(axes):
        for label in dict.fromkeys(group.labels[axis] for group in groups):
            same = {group.labels for group in overview.groups if group.labels[axis] == label}
            if len(axes) > 1 and same <= {group.labels for group in groups} and same & left:
                texts.setdefault(overview.within[axis], []).append(str(label))
                left -= same
    for group in groups:
        if group.labels in left:
            first = [f"{overview.within[axis]} {group.labels[axis]}" for axis in axes[:-1]]
            name = ", ".join([*first, overview.within[axes[-1]]])
            texts.setdefault(name, []).append(str(group.labels[axes[-1]]))
    named = [f"{escape(name)} {escape(both(labels))}" for name, labels in texts.items()]
    return " and for ".join(filter(None, [", ".join(named[:-1]), *named[-1:]]))


def _against(overview: Overview, known: Sequence[GroupOverview]) -> str:
    """Return where methods are better than the baseline, and where they are not.

    There is a sentence for each combination of the labels of all axes but the last.
    """
    against = overview.against
    if against is None:
        return ""
    judged = [group for group in known if group.judged and np.isfinite(group.mean[against])]
    axes = varying(overview)
    parts: dict[str, list[GroupOverview]] = {}
    for group in judged:
        labels = [f"{overview.within[axis]} {group.labels[axis]}" for axis in axes[:-1]]
        parts.setdefault(", ".join(labels), []).append(group)
    (baseline,) = method_names(overview, [against])
    texts = []
    for part, groups in parts.items():
        same: dict[str, list[int]] = {}
        for place in range(len(overview.methods)):
            where = [group for group in groups if np.isfinite(group.mean[place])]
            if place != against and where:
                same.setdefault(_apart(overview, place, where), []).append(place)
        clauses = [
            f"{both(method_names(overview, places))} {'are' if len(places) > 1 else 'is'} {clause}"
            for clause, places in same.items()
        ]
        rest = len(clauses) - _MOST_CLAUSES
        more = f"; {rest} more are in the table" if rest > 0 else ""
        start = f" Against {baseline}{f', {escape(part)}' if part else ''}: "
        texts.append(f"{start}{'; '.join(clauses[:_MOST_CLAUSES])}{more}.")
    rest = len(texts) - _MOST_CLAUSES
    more = f" {rest} more are in the table." if rest > 0 else ""
    return "".join(texts[:_MOST_CLAUSES]) + more


def _apart(overview: Overview, place: int, groups: Sequence[GroupOverview]) -> str:
    """Return in which groups a method is better than the baseline, worse, or neither."""
    verdicts: dict[str, list[GroupOverview]] = {"better": [], "worse": [], "": []}
    for group in groups:
        word = "better" if place in group.better else "worse" if place in group.worse else ""
        verdicts[word].append(group)
    words = [word for word, where in verdicts.items() if where]
    if len(words) == 1:
        alike = f"{words[0]} throughout" if words[0] else "nowhere clearly apart"
        return alike if len(groups) > 1 else words[0] or "not clearly apart"
    axis = varying(overview)[-1]
    name = escape(overview.within[axis])
    return ", ".join(
        f"{word or 'not clearly apart'} at {name} "
        f"{escape(both([str(group.labels[axis]) for group in verdicts[word]]))}"
        for word in words
    )


def _compromise(overview: Overview, stands: Sequence[GroupOverview]) -> str:
    """Return the method that is never far behind, and its largest distance."""
    if not overview.ratio or len(stands) < 2:
        return ""
    ratios = np.stack([group.ratio for group in stands])
    for row, group in zip(ratios, stands, strict=True):
        row[list(group.best)] = 1.0
    times = 1.0 / ratios if overview.metric.better == "higher" else ratios
    worst = np.where(np.isfinite(times).all(axis=0), times.max(axis=0), np.inf)
    place = int(np.argmin(worst))
    if not np.isfinite(worst[place]):
        return ""
    (name,) = method_names(overview, [place])
    behind = max(float(worst[place]) - 1, 0.0)
    if behind >= 1:
        return f" One method for all: {name}, never more than {worst[place]:.1f} times the best."
    # rounded up: `never more than`
    return (
        f" One method for all: {name}, never more than {math.ceil(100 * behind)} % behind the best."
    )
