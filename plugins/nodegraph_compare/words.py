"""The words for verdicts: what they hold for, why there is none, who is best, tied and behind.

A sentence on all groups is HTML, in which methods are marked; a line on a group is plain text.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from markupsafe import Markup, escape

from nodegraph import listed
from nodegraph_compare.inference import FEWEST, FEWEST_SETTLED, LEVEL
from nodegraph_compare.left_out import MOST_GROUPS, narrowed, start_text
from nodegraph_compare.question import EXTREME
from nodegraph_compare.units import MOST_RECORDINGS
from nodegraph_compare.verdict import COMMON
from nodegraph_tables.lead import MOST_CARDS
from nodegraph_tables.numbers import SMALLEST, SPACE, percent, shares_text, span_text
from nodegraph_tables.style import scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nodegraph import Label, Origin
    from nodegraph_compare.question import Question
    from nodegraph_compare.units import Shortage
    from nodegraph_compare.verdict import Metric, Paired, Rule, Scope, Verdict, Verdicts

UNCLEAR = "with no clear change"
ALL_BEHIND = "every other is clearly behind"

_FEW_BLOCKS = 10
_MOST_IN_SIGHT = 4
_MOST_NAMES = 3
_MOST_CLAUSES = 6
_MOST_TIED = 2
_MOST_TIES = 5
"""Names in a line; the table marks all of them."""


# what a result holds for, and what it rests on


def scope_text(scope: Scope) -> str:
    """Return what a result holds for: ``over 8 actors``, ``for further gaps in this recording``."""
    if scope.kind == "clusters":
        return f"over {scope.clusters} {scope.several}"
    if not scope.blocks:
        return f"for further {scope.several}"
    where = "this recording" if scope.clusters == 1 else f"these {scope.clusters} recordings"
    if scope.kind == "segments":
        return f"for the next minutes of {where}"
    return f"for further {scope.blocks} in {where}"


def units_text(scope: Scope) -> str:
    """Return the number of units with their name: ``8 actors``, ``10 segments``."""
    if scope.kind == "clusters":
        return f"{scope.clusters} {scope.several}"
    named = {
        "segments": "segments of the recording",
        "draws": "repetitions",
    }
    return f"{scope.units} {named.get(scope.kind, 'recordings')}"


def caution_text(scope: Scope) -> str:
    """Return why nothing can be said, or what too few units leave open; empty for enough."""
    if scope.speech == "nothing":
        return _shortage_text(scope) or f"{scope.count} units"
    if scope.speech == "described":
        return f"{units_text(scope)} describe the methods and decide nothing"
    if scope.speech == "provisional":
        return f"provisional, as of {units_text(scope)}"
    return ""


def _shortage_text(scope: Scope) -> str:
    shortage = scope.shortage
    if shortage is None:
        return ""
    if shortage.of == "numbers":
        return "no block has a number for every method"
    if shortage.of == "repetitions":
        there = f"{shortage.there:.0f}" if shortage.there > 1 else "one"
        few = (
            f"{there} repetition{'s' * (shortage.there > 1)} where {shortage.needed:.0f} are needed"
        )
    else:
        few = f"fewer than three repetitions, and {_segments_text(scope, shortage)}"
    if not scope.drawn:
        return f"{few}; an axis of repetitions, each with damage of its own, would help"
    return f'{few}; ten draws help: --axis "{scope.drawn}={{count: 10}}"'


def _segments_text(scope: Scope, shortage: Shortage) -> str:
    """Return why a recording has no segments."""
    there, needed = f"{shortage.there:,.0f}", f"{shortage.needed:,.0f}"
    if shortage.of == "frames":
        return f"{there} frames where {needed} are needed"
    of = scope.blocks or "blocks"
    return f"{there} {of} leave one of {needed} segments of time without any"


def few_blocks_text(scope: Scope) -> str:
    """Return a remark on units of so few blocks that the means of skewed errors are biased."""
    if scope.kind != "clusters" or not 1 < scope.fewest < _FEW_BLOCKS:
        return ""
    return (
        f"fewer than {_FEW_BLOCKS} blocks in some of the {scope.several} "
        f"(at least {scope.fewest}): means of skewed errors are biased"
    )


def rules_text(question: Question, several: str, clusters: int) -> str:
    """Return what units are, and how many of them say how much.

    Parameters
    ----------
    question
        Of the comparison.
    several
        What several clusters are called.
    clusters
        How many there are.
    """
    if question.clusters and clusters > MOST_RECORDINGS:
        return (
            f"The independent units are {several}, which weigh equally: three or four are "
            f"described without p, fewer than {FEWEST_SETTLED} are provisional."
        )
    one = "one recording" if clusters == 1 else f"{clusters} recordings"
    return (
        f"All blocks are of {one}, and results hold for no other. The units are repetitions, which "
        f"say what further ones would; or, without {FEWEST} of these, equal segments, long against "
        "the time over which a recording is correlated, which say what its next minutes would. "
        f"Fewer than {FEWEST_SETTLED} units are provisional."
    )


def rule_text(rule: Rule, blocks: str) -> str:
    """Return a rule for missing blocks as a sentence has it: ``over common gaps``."""
    if rule == COMMON:
        return f"over common {blocks}"
    return f"with the worst error of {blocks} instead"


def reason_text(verdicts: Verdicts, group: Verdict) -> str:
    """Return why a group has no verdict."""
    if objection := _objection(verdicts, group):
        return f"the rules for missing blocks disagree: {objection}"
    return caution_text(group.scope)


def _objection(verdicts: Verdicts, group: Verdict) -> str:
    return " and ".join(
        f"{rule_text(rule, verdicts.blocks)} {_best_instead(verdicts, other)}"
        for rule, other in group.objections.items()
    )


def _best_instead(verdicts: Verdicts, other: Verdict) -> str:
    if not other.best:
        return "nothing can be said"
    names = plain_names(verdicts, other.best)
    return f"{listed(names)} {'share' if len(names) > 1 else 'has'} the best mean"


def change_of(verdicts: Verdicts, group: Verdict, other: Verdict) -> str:
    """Return what another rule says in place of a verdict; empty where it says the same."""
    if other.best != group.best:
        return _best_instead(verdicts, other)
    behind, still = group.worse_than_best, other.worse_than_best
    gone = [place for place in behind if place not in still]
    new = [place for place in still if place not in behind]
    return " and ".join(
        f"{listed(plain_names(verdicts, places))} {'are' if len(places) > 1 else 'is'} {how} "
        "clearly behind"
        for places, how in ((gone, "no longer"), (new, "also"))
        if places
    )


# numbers and names


def number_name(verdicts: Verdicts, unit: str = "") -> str:
    """Return what the number of a method is: ``Mean rmse (mm) of a typical actor``.

    Parameters
    ----------
    verdicts
        Of the comparison.
    unit
        Of the metric, as a reader sees it.
    """
    mean = f"Mean {verdicts.metric.name}{f' ({unit})' if unit else ''}"
    clusters = max((group.scope.clusters for group in verdicts.groups), default=1)
    if clusters == 1:
        return f"{mean} over {verdicts.blocks}"
    if not verdicts.ratio:
        return f"{mean} over {verdicts.units}"
    unit = verdicts.units.removesuffix("s").replace("combinations of", "combination of")
    return f"{mean} of a typical {unit}"


def in_unit(values: Sequence[float], unit: str) -> str:
    """Return numbers from first to last with their unit, escaped; shares in percent."""
    return str(escape(span_text(values, unit)))


def signed(value: float, unit: str, mean: float) -> str:
    """Return a difference with its sign, to the digits of the mean that it is to."""
    shown = round(value, 3) if abs(mean) >= SMALLEST else value
    if value and not shown:
        return f"under {in_unit([SMALLEST], unit)}"
    return f"{'+' if shown >= 0 else ''}{in_unit([shown], unit)}"


def beside_text(values: Sequence[float], metric: Metric) -> str:
    """Return means of the metrics shown next to the first, from first to last, in few digits."""
    return shares_text(values) if metric.unit == "share" else in_unit(values, metric.unit)


def method_names(verdicts: Verdicts, places: Iterable[int]) -> list[str]:
    """Return the names of methods as HTML, each marked with what it is a name of.

    A number is named with what it is a value of: ``threshold 2``.
    """
    return [
        f'<strong data-method="{escape(str(label))}">{escape(_name(verdicts, label))}</strong>'
        for label in (verdicts.methods[place] for place in places)
    ]


def _name(verdicts: Verdicts, label: Label) -> str:
    return str(label) if isinstance(label, str) else f"{verdicts.compare} {label}"


def plain_names(verdicts: Verdicts, places: Iterable[int]) -> list[str]:
    """Return the labels of methods as text."""
    return [str(verdicts.methods[place]) for place in places]


def few(texts: Sequence[str], most: int = _MOST_NAMES) -> str:
    """Return the first texts: ``a, b, c and 4 more``."""
    more = len(texts) - most
    return ", ".join(texts[:most]) + (f" and {more} more" if more > 0 else "")


def both(texts: Sequence[str], word: str = "and") -> str:
    """Return texts as a list: ``a, b and c``."""
    return f" {word} ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


def count_text(count: int, several: str) -> str:
    """Return a number of things: ``10 gaps``, ``1 gap``."""
    return f"{count:,} {escape(several if count != 1 else several.removesuffix('s'))}"


def label_text(label: Label, unit: str = "") -> str:
    """Return a label as a reader sees it: numbers without useless digits, with their unit."""
    if isinstance(label, bool) or not isinstance(label, (int, float)):
        return str(label)
    if unit == "share":
        return f"{100 * label:.10g}{SPACE}%"
    if label == 1 and len(unit) > 1:
        unit = unit.removesuffix("s")  # 1 frame
    return f"{label:.12g}{SPACE}{unit_text(unit)}".rstrip(SPACE)


def with_units(verdicts: Verdicts, origin: Origin) -> Verdicts:
    """Return verdicts whose labels are texts with their units: ``5 frames``, ``2 %``."""
    units = [origin.unit(axis) for axis in verdicts.within]
    groups = (
        replace(group, labels=tuple(map(label_text, group.labels, units)))
        for group in verdicts.groups
    )
    return replace(verdicts, groups=tuple(groups))


def group_title(verdicts: Verdicts, group: Verdict, axes: Sequence[int] | None = None) -> str:
    """Return the labels of a group along some axes, by default those in which groups differ."""
    axes = varying(verdicts) if axes is None else axes
    return ", ".join(f"{verdicts.within[axis]} {group.labels[axis]}" for axis in axes)


def varying(verdicts: Verdicts) -> list[int]:
    """Return the places in `within` of the axes along which groups differ; all, if none does."""
    axes = [
        axis
        for axis in range(len(verdicts.within))
        if len({group.labels[axis] for group in verdicts.groups}) > 1
    ]
    return axes or list(range(len(verdicts.within)))


def has_panels(verdicts: Verdicts) -> bool:
    """Whether only the cards of one label of the first axis are in sight."""
    return _MOST_IN_SIGHT < len(verdicts.groups) <= MOST_CARDS and len(varying(verdicts)) > 1


# a sentence or two on all groups, as HTML


def sentences(verdicts: Verdicts) -> dict[str, str]:
    """Return the answer in a sentence or two, as HTML, for each part of a reader's first view.

    Where cards stand in panels, each panel has an answer of its own, by the label of the panel;
    otherwise there is one, without a label.
    """
    if not has_panels(verdicts):
        return {"": _sentence(verdicts)}
    first = varying(verdicts)[:1]
    parts: dict[str, list[Verdict]] = {}
    for group in verdicts.groups:
        parts.setdefault(group_title(verdicts, group, first), []).append(group)
    return {
        label: _sentence(replace(verdicts, groups=tuple(groups))) for label, groups in parts.items()
    }


def _sentence(verdicts: Verdicts) -> str:
    known = [group for group in verdicts.groups if group.known]
    metric = verdicts.metric
    if not known:
        return "No block has a number for every method: nothing can be said."
    if all(len(group.known) == 1 for group in known):
        return _values(verdicts, known)
    if metric.better == "none":
        return f"Neither end of {escape(metric.name)} is the better one: what follows describes it."
    stands = [group for group in known if group.stands]
    if not stands:
        reasons = list(dict.fromkeys(reason_text(verdicts, group) for group in known))
        others = len(reasons) - 1
        more = f" (and {others} more reason{'s' * (others > 1)})" if others else ""
        what = (
            f"what each {escape(verdicts.compare)} does"
            if verdicts.is_sequence
            else "which is best"
        )
        first = f"The data cannot tell {what}: {escape(reasons[0])}{more}."
        return f"{first}{_extreme_everywhere(verdicts, known)}{_against(verdicts, known)}"
    if verdicts.is_sequence:
        return _steps(verdicts, stands)
    if not any(group.told for group in stands):
        first = "The data cannot tell which is best: no difference is clear."
        beside = f"{_against(verdicts, known)}{_absent(verdicts, known)}"
        return f"{first}{_extreme_everywhere(verdicts, known)}{beside}"
    rest = len(known) - len(stands)
    verb = "have" if rest > 1 else "has"
    without = f" {rest} of {len(known)} groups {verb} no verdict." if rest else ""
    leaders = set.intersection(*(set(group.best) for group in stands))
    if leaders:
        answer = _throughout(verdicts, stands, sorted(leaders))
    else:
        answer = f"{_depends(verdicts, stands)}{_compromise(verdicts, stands)}"
    absent = _absent(verdicts, known)
    return f"{answer}{_against(verdicts, known)}{_besides(verdicts, stands)}{without}{absent}"


def _absent(verdicts: Verdicts, known: Sequence[Verdict]) -> str:
    """Return which methods have no number in some group, which are neither good nor behind."""
    absent = sorted({place for group in known for place in group.not_compared})
    if not absent:
        return ""
    where = "" if all({*absent} <= {*group.not_compared} for group in known) else " everywhere"
    names = few(method_names(verdicts, absent))
    return f" Not compared{where}, without any number: {names}."


def _steps(verdicts: Verdicts, stands: Sequence[Verdict]) -> str:
    """Return the effect of each step on the mean, with the groups in which it has it."""
    clauses: list[str] = []
    for step in sorted({step for group in stands for step in changes(group)}):
        does: dict[str, list[str]] = {}
        for group in stands:
            if step in (differences := changes(group)):
                before, verb = differences[step]
                by = f"by {change_text(verdicts, group, before, step)} " * (verb != UNCLEAR)
                where = _where(verdicts, [group])
                does.setdefault(verb, []).append(f"{by}({where})" if where else by.strip())
        (name,) = method_names(verdicts, [step])
        metric = "it" if clauses else escape(verdicts.metric.name)
        parts = [
            f"{verb} {f'{metric} ' * (verb != UNCLEAR)}{both(sizes)}"
            for verb, sizes in sorted(does.items())
        ]
        clauses.append(f"{name} {', '.join(parts)}")
    return f"{'; '.join(clauses)}."


def changes(group: Verdict) -> dict[int, tuple[int, str]]:
    """Return the step before each step, and whether this one lowers or raises the mean."""
    return {
        step: (before, ("lowers" if group.mean[step] < group.mean[before] else "raises")
               if group.stands and group.p_of_step[step] <= LEVEL else UNCLEAR)
        for before, step in pairwise(group.known)
    }  # fmt: skip


def change_text(verdicts: Verdicts, group: Verdict, before: int, step: int) -> str:
    """Return the distance between the means of two steps: ``36 %``, or ``0.12 mm``."""
    first, second = float(group.mean[before]), float(group.mean[step])
    if verdicts.ratio and first > 0:
        return percent(abs(second / first - 1))
    return in_unit([abs(second - first)], verdicts.metric.unit)


def _besides(verdicts: Verdicts, stands: Sequence[Verdict]) -> str:
    """Return what else the best methods do."""
    texts = []
    for metric in verdicts.beside:
        means = [float(group.beside[metric.name][group.best[0]]) for group in stands]
        texts.append(f"{escape(metric.name)} {beside_text([min(means), max(means)], metric)}")
    return f" Of the best: {both(texts)}." if texts else ""


def _extreme_everywhere(verdicts: Verdicts, known: Sequence[Verdict]) -> str:
    """Return which methods are best in all of several groups."""
    leaders = set.intersection(*(set(group.best) for group in known))
    if not leaders or len(known) < 2:
        return ""
    names = both(method_names(verdicts, sorted(leaders)))
    verb = "come" if len(leaders) > 1 else "comes"
    return f" {names} {verb} first in all {len(known)} groups."


def _values(verdicts: Verdicts, known: Sequence[Verdict]) -> str:
    """Return the mean of the only method, or the range of its means."""
    place = known[0].known[0]
    means = [float(np.nanmin(group.mean)) for group in known]
    of = f" of {method_names(verdicts, [place])[0]}" if str(verdicts.methods[place]) else ""
    ends = in_unit(sorted({min(means), max(means)}), verdicts.metric.unit)
    alone = " There is nothing to compare it to." if of else ""
    return f"The mean {escape(verdicts.metric.name)}{of} is {ends}.{alone}"


def _throughout(verdicts: Verdicts, stands: Sequence[Verdict], leaders: Sequence[int]) -> str:
    names = both(method_names(verdicts, leaders))
    verb = "are" if len(leaders) > 1 else "is"
    where, count = "", len(verdicts.groups)
    if len(stands) < count:
        where = f" in {len(stands)} of {count} groups"
    elif count > 1:
        where = " throughout"
    if all(len(group.known) == len(leaders) for group in stands):
        return f"{names} have the same mean {escape(verdicts.metric.name)}{where}."
    tied = set.intersection(*(set(group.tied) for group in stands))
    if tied:
        order = sorted(tied, key=lambda place: abs(stands[0].to_best_of(place)))
        apart = f", but tied with {few(method_names(verdicts, order))}."
    elif any(group.tied for group in stands):
        apart = ", in places tied with others."
    else:
        apart = f"; {ALL_BEHIND}."
    return f"{names} {verb} best{where}{apart}"


def _depends(verdicts: Verdicts, stands: Sequence[Verdict]) -> str:
    """Return which method is the best where, the groups with the same best together."""
    by_leader: dict[int, list[Verdict]] = {}
    for group in stands:
        by_leader.setdefault(group.best[0], []).append(group)
    axes = both([escape(verdicts.within[axis]) for axis in varying(verdicts)])
    if len(by_leader) > _MOST_CLAUSES:
        counts = sorted(by_leader.items(), key=lambda item: -len(item[1]))
        names = [
            f"{method_names(verdicts, [place])[0]} in {len(groups)}" for place, groups in counts
        ]
        return f"It depends on {axes}: of {len(stands)} groups, {few(names)} have another best."
    clauses = [
        f"{_alternatives(verdicts, place, groups)} for {_where(verdicts, groups)}"
        for place, groups in by_leader.items()
    ]
    most = max(by_leader, key=lambda place: len(by_leader[place]))
    several = len(varying(verdicts)) > 1 and len(by_leader[most]) > 1
    if several and len(by_leader) > 1 and len(stands) == len(verdicts.groups):
        del clauses[list(by_leader).index(most)]
        clauses.append(f"{_alternatives(verdicts, most, by_leader[most])} otherwise")
    return f"It depends on {axes}: {'; '.join(clauses)}."


def _alternatives(verdicts: Verdicts, leader: int, groups: Sequence[Verdict]) -> str:
    """Return the best of groups, with the methods not clearly apart from it in any of them."""
    tied = set.intersection(*({*group.tied, *group.best} for group in groups)) - {leader}
    (name,) = method_names(verdicts, [leader])
    if len(tied) > _MOST_TIED:
        return f"{name} (tied with {len(tied)} others)"
    if not tied and any(group.tied for group in groups):
        return f"{name} (with ties)"
    order = sorted(tied, key=lambda place: np.nanmax([abs(g.to_best_of(place)) for g in groups]))
    return both([name, *(escape(str(verdicts.methods[place])) for place in order)], "or")


def _where(verdicts: Verdicts, groups: Sequence[Verdict]) -> str:
    """Return the labels of groups, by as few of them as tell them from all others."""
    axes = varying(verdicts)
    if len(axes) == 1:
        return escape(both([str(group.labels[axes[0]]) for group in groups]))
    left = {group.labels for group in groups}
    texts: dict[str, list[str]] = {}
    for axis in reversed(axes):
        for label in dict.fromkeys(group.labels[axis] for group in groups):
            same = {group.labels for group in verdicts.groups if group.labels[axis] == label}
            if len(axes) > 1 and same <= {group.labels for group in groups} and same & left:
                texts.setdefault(verdicts.within[axis], []).append(str(label))
                left -= same
    for group in groups:
        if group.labels in left:
            first = group_title(verdicts, group, axes[:-1])
            name = ", ".join(filter(None, [first, verdicts.within[axes[-1]]]))
            texts.setdefault(name, []).append(str(group.labels[axes[-1]]))
    named = [f"{escape(name)} {escape(both(labels))}" for name, labels in texts.items()]
    return " and for ".join(filter(None, [", ".join(named[:-1]), *named[-1:]]))


def _against(verdicts: Verdicts, known: Sequence[Verdict]) -> str:
    """Return where methods are better than the baseline, and where they are not.

    There is a sentence for each combination of the labels of all axes but the last.
    """
    if verdicts.baseline is None:
        return ""
    against = verdicts.methods.index(verdicts.baseline)
    judged = [group for group in known if group.judged and np.isfinite(group.mean[against])]
    axes = varying(verdicts)
    parts: dict[str, list[Verdict]] = {}
    for group in judged:
        parts.setdefault(group_title(verdicts, group, axes[:-1]), []).append(group)
    (baseline,) = method_names(verdicts, [against])
    texts = []
    for part, groups in parts.items():
        same: dict[str, list[int]] = {}
        for place in range(len(verdicts.methods)):
            where = [group for group in groups if np.isfinite(group.mean[place])]
            if place != against and where:
                same.setdefault(_beside_baseline(verdicts, place, where), []).append(place)
        clauses = [
            f"{both(method_names(verdicts, places))} {'are' if len(places) > 1 else 'is'} {clause}"
            for clause, places in same.items()
        ]
        rest = len(clauses) - _MOST_CLAUSES
        more = f"; {rest} more are in the table" if rest > 0 else ""
        start = f" Against {baseline}{f', {escape(part)}' if part else ''}: "
        texts.append(f"{start}{'; '.join(clauses[:_MOST_CLAUSES])}{more}.")
    rest = len(texts) - _MOST_CLAUSES
    more = f" {rest} more are in the table." if rest > 0 else ""
    return "".join(texts[:_MOST_CLAUSES]) + more


def _beside_baseline(verdicts: Verdicts, place: int, groups: Sequence[Verdict]) -> str:
    """Return in which groups a method is better than the baseline, worse, or neither."""
    worse: Literal["lower", "higher"] = "lower" if verdicts.metric.better == "higher" else "higher"
    better: Literal["lower", "higher"] = "higher" if worse == "lower" else "lower"
    where: dict[str, list[Verdict]] = {"better": [], "worse": [], "": []}
    for group in groups:
        is_better = place in group.beyond_baseline(better)
        word = "better" if is_better else "worse" * (place in group.beyond_baseline(worse))
        where[word].append(group)
    words = [word for word, of in where.items() if of]
    if len(words) == 1:
        alike = f"{words[0]} throughout" if words[0] else "nowhere clearly apart"
        return alike if len(groups) > 1 else words[0] or "not clearly apart"
    axis = varying(verdicts)[-1]
    name = escape(verdicts.within[axis])
    return ", ".join(
        f"{word or 'not clearly apart'} at {name} "
        f"{escape(both([str(group.labels[axis]) for group in where[word]]))}"
        for word in words
    )


def _compromise(verdicts: Verdicts, stands: Sequence[Verdict]) -> str:
    """Return the method that is never far behind, and its largest distance."""
    if not verdicts.ratio or len(stands) < 2:
        return ""
    ratios = []
    for group in stands:
        known = np.full(group.mean.shape, np.nan) if group.to_best is None else group.to_best.value
        ratios.append(np.where(np.isin(np.arange(len(known)), group.best), 1.0, known))
    every = np.stack(ratios)
    times = 1.0 / every if verdicts.metric.better == "higher" else every
    worst = np.where(np.isfinite(times).all(axis=0), times.max(axis=0), np.inf)
    place = int(np.argmin(worst))
    if not np.isfinite(worst[place]):
        return ""
    (name,) = method_names(verdicts, [place])
    behind = max(float(worst[place]) - 1, 0.0)
    if behind >= 1:
        return f" One method for all: {name}, never more than {worst[place]:.1f} times the best."
    # rounded up: `never more than`
    return (
        f" One method for all: {name}, never more than {math.ceil(100 * behind)} % behind the best."
    )


# what the verdicts hold for, and how they are read, as HTML


def scope_sentences(verdicts: Verdicts) -> Markup:
    """Return what the verdicts hold for, and what the numbers are."""
    groups = verdicts.groups
    first = groups[0].scope if groups else None
    metric = verdicts.metric
    judged = any(group.stands for group in groups)
    over_clusters = first is not None and first.kind == "clusters"
    scope = "" if first is None else scope_text(first)
    if over_clusters:
        what = "Holds" if judged else "Only the intervals hold"
        further = escape(verdicts.units)
        holds = (
            f"<strong>Scope: {escape(scope.removeprefix('over '))}. {what} for further {further}"
        )
        holds += " of this generator</strong>, untested on people." * verdicts.synthetic
        holds += "</strong>." * (not verdicts.synthetic)
    elif scope and not judged:
        holds = f"<strong>Scope</strong>: nothing is said {escape(scope)}."
    elif scope:
        holds = f"<strong>Scope: holds {escape(scope)}</strong>, not for others."
    else:
        holds = ""
    cautions = Counter(caution_text(group.scope) for group in groups if group.stands)
    of_some = "".join(
        f" {escape(text[:1].upper() + text[1:])}"
        f"{'' if count == len(groups) else f' (in {count} of {len(groups)} groups)'}."
        for text, count in cautions.items()
        if text
    )
    several = sum(group.stands for group in groups)
    shared = (
        f" Each of these {several} verdicts errs in up to 5 % of studies: a claim that rests on "
        f"any one of them multiplies its p by {several}."
        if several > 1
        else ""
    )
    end = "neither end is better" if metric.better == "none" else f"{metric.better} is better"
    unit = in_unit([], metric.unit).strip()
    numbers = f"{escape(number_name(verdicts, unit))}, {end}."
    return Markup(f"{holds}{of_some} {numbers}{shared}")


def legend(verdicts: Verdicts, *, logarithmic: bool) -> str:
    """Return what the dots of the cards are, and what tied means."""
    stands = [group for group in verdicts.groups if group.stands]
    if not stands or len(verdicts.groups) > MOST_CARDS or len(verdicts.methods) < 2:
        return ""
    if verdicts.is_sequence:
        return (
            f" Percentages: to the {escape(verdicts.compare)} before; dots: hollow where it begins,"
            " blue clearly better than before, orange clearly worse, grey not clearly changed."
        )
    stands = [group for group in stands if group.marks]
    if not stands:
        return ""
    tied = (
        "; ringed: <strong>tied</strong>, paired differences cannot tell it from the best"
        if any(group.tied for group in stands)
        else ""
    )
    behind = "; grey: clearly behind" if any(group.behind for group in stands) else ""
    scale = ", on a logarithmic scale" if logarithmic else ""
    return f" Dots: a method each{scale}; filled: the best{tied}{behind}."


# a line on each group, as text


def lines(verdicts: Verdicts) -> list[str]:
    """Return a line on each group, or on all of them where there are many, and one over all."""
    groups = verdicts.groups
    metric = verdicts.metric
    over_all = []
    if verdicts.overall is not None:
        best = _best(verdicts, verdicts.overall)
        verdict = _verdict(verdicts, verdicts.overall)
        over_all = [f"all {len(groups)} groups: {best}{verdict}."]
    if len(groups) > MOST_GROUPS and verdicts.compare and metric.better != "none":
        return [_counted(verdicts), *_narrow(verdicts), *_unsteady(verdicts), *over_all]
    result = []
    for same in _alike(verdicts, groups[:MOST_GROUPS]):
        start = _start(verdicts, same)
        result.append(f"{start}{_means(verdicts, same)}{_verdict(verdicts, same[0])}.")
        for group in same:
            result += _beyond_baseline(verdicts, group)
    rest = len(groups) - MOST_GROUPS
    return [*result, *([f"{rest} more groups are in the table."] if rest > 0 else []), *over_all]


def _alike(verdicts: Verdicts, groups: Sequence[Verdict]) -> list[list[Verdict]]:
    """Return the groups whose lines differ only in their numbers, together."""
    together: dict[object, list[Verdict]] = {}
    for place, group in enumerate(groups):
        text = _verdict(verdicts, group)
        key = text if group.best and group.judged else place
        best = group.best and _best(verdicts, group)
        together.setdefault((best, key), []).append(group)
    return list(together.values())


def _means(verdicts: Verdicts, same: Sequence[Verdict]) -> str:
    """Return the best mean of a group, or of groups that are alike."""
    group, metric = same[0], verdicts.metric.name
    used = np.flatnonzero(group.blocks).tolist()
    if not used:
        return "no block has a number for every method; nothing can be said"
    if not verdicts.compare:
        return f"the mean {metric} is known ({_numbers(verdicts, group, 0)})"
    if len(used) == 1:
        (only,) = plain_names(verdicts, used)
        return f"only {only} has a mean {metric} ({_numbers(verdicts, group, used[0])})"
    if not group.best:
        ends = (int(np.nanargmin(group.mean)), int(np.nanargmax(group.mean)))
        names = plain_names(verdicts, ends)
        low, high = (
            f"{name} ({_numbers(verdicts, group, at)})"
            for name, at in zip(names, ends, strict=True)
        )
        return f"the mean {metric} is lowest for {low} and highest for {high}"
    best = _best(verdicts, group)
    if len(same) == 1:
        return f"{best} ({_numbers(verdicts, group, group.best[0])})"
    means = [float(each.mean[each.best[0]]) for each in same if each.best]
    return f"{best} ({_valued(sorted({min(means), max(means)}), verdicts.metric.unit)})"


def best_names(verdicts: Verdicts, group: Verdict) -> str:
    """Return which methods are best."""
    return listed(plain_names(verdicts, group.best))


def _best(verdicts: Verdicts, group: Verdict) -> str:
    """Return which methods are best, and by what: ``near has the lowest mean rmse``."""
    verb = "share" if len(group.best) > 1 else "has"
    extreme = f"the {EXTREME[group.better]} mean {verdicts.metric.name}"
    return f"{best_names(verdicts, group)} {verb} {extreme}"


def _verdict(verdicts: Verdicts, group: Verdict) -> str:
    """Return the text after the best mean: its scope, and the methods not behind."""
    if np.count_nonzero(group.blocks) < 2 or not group.best:
        return ""
    scope, caution = scope_text(group.scope), caution_text(group.scope)
    if group.scope.speech == "nothing":
        return f"; nothing can be said {scope}: {caution}"
    texts = _apart(verdicts, group) if group.judged else []
    if objection := _objection(verdicts, group):
        texts = [f"no verdict stands: {objection}"]
    elif group.judged and verdicts.margin is not None and group.paired is not None:
        texts.append(_equal(verdicts, group, group.paired))
    other = group.without_suspects
    if other is not None and other.best != group.best:
        texts.append(f"without suspect {verdicts.blocks} {_best_instead(verdicts, other)}")
    texts += filter(None, [caution])
    if group.next_minutes is not None:
        texts.append(_next_minutes(verdicts, group.next_minutes))
    return f" {scope}" + "".join(f"; {text}" for text in texts)


def _apart(verdicts: Verdicts, group: Verdict) -> list[str]:
    close, behind = plain_names(verdicts, group.tied), len(group.behind)
    absent = plain_names(verdicts, group.not_compared)
    without = f"; not compared, without any number: {listed(absent, _MOST_TIES)}" if absent else ""
    if not close:
        return [f"{ALL_BEHIND}{without}"] if behind else []
    best = "them" if len(group.best) > 1 else "it"
    rest = f"; the {'other' if behind == 1 else f'other {behind}'} clearly behind"
    names = listed(close, _MOST_TIES)
    return [f"not clearly apart from {best}: {names}{rest if behind else ''}{without}"]


def _next_minutes(verdicts: Verdicts, group: Verdict) -> str:
    """Return what the segments of a recording say, beside its repetitions."""
    scope = scope_text(group.scope)
    if group.scope.shortage is not None:
        lacking = _segments_text(group.scope, group.scope.shortage)
        return f"nothing can be said for its next minutes: {lacking}"
    apart = _apart(verdicts, group) or ["nothing is apart"]
    return f"{scope} ({units_text(group.scope)}) {'; '.join(apart)}"


def _numbers(verdicts: Verdicts, group: Verdict, place: int) -> str:
    """Return a mean with its interval, and its number of blocks where some are left out."""
    unit = verdicts.metric.unit
    text = _valued([float(group.mean[place])], unit)
    if np.isfinite(group.low[place]):
        ends = [float(group.low[place]), float(group.high[place])]
        interval = _valued(ends, unit if unit == "share" else "")
        # one without width in the digits shown says nothing
        text += f", interval {interval}" if " to " in interval else ""
    used, total = int(group.blocks[place]), group.of_blocks
    return text if used == total else f"{text}, {used} of {total} {verdicts.blocks}"


def _equal(verdicts: Verdicts, group: Verdict, paired: Paired) -> str:
    """Return which methods are practically equal to what they are compared to."""
    names = plain_names(verdicts, group.equal)
    (to,) = plain_names(verdicts, [paired.reference])
    if names:
        return f"equal to {to} within {verdicts.margin}: {listed(names)}"
    place = int(np.nanargmin(paired.margin))
    (nearest,) = plain_names(verdicts, [place])
    shown = f"{nearest} within {paired.margin[place]:.3g}"
    return f"none is shown to be equal to {to} within {verdicts.margin} (nearest: {shown})"


def _counted(verdicts: Verdicts) -> str:
    groups, metric = verdicts.groups, verdicts.metric
    bests = (name for each in groups for name in plain_names(verdicts, each.best) or ["none"])
    (first, most), *wins = Counter(bests).most_common()
    rest = f", {listed([f'{name} in {count}' for name, count in wins])}" if wins else ""
    alone = sum(
        each.judged and {*np.flatnonzero(each.blocks).tolist()} <= {*each.behind, *each.best}
        for each in groups
    )
    held = {scope_text(each.scope) for each in groups if each.scope.count}
    return (
        f"Of {len(groups)} groups ({', '.join(verdicts.within)}), {first} has the "
        f"{EXTREME[metric.better]} mean {metric.name} in {most}{rest}"
        f"{f' {listed(sorted(held))}' if held else ''}; all others are clearly behind in {alone}."
    )


def _narrow(verdicts: Verdicts) -> list[str]:
    """Return a note on the groups in which blocks are left out, with an example."""
    texts = []
    for group in verdicts.groups:
        usable = [place for place in group.ranked if group.lacking[place] < group.of_blocks]
        lacking = [(verdicts.methods[p], int(group.lacking[p])) for p in sorted(usable)]
        used = int(group.blocks.max(initial=0)) if usable else group.of_blocks
        texts.append(narrowed(lacking, used, group.of_blocks, verdicts.blocks))
    narrow = [text for text in texts if text]
    if not narrow:
        return []
    return [
        f"In {len(narrow)} of them {verdicts.blocks} are left out, because not every method has "
        f"them ({narrow[0]})."
    ]


def _unsteady(verdicts: Verdicts) -> list[str]:
    """Return a note on the groups in which another rule gives another answer."""
    by_rule = [
        any(change_of(verdicts, group, other) for other in group.by_rule.values())
        for group in verdicts.groups
    ]
    plain = [
        group.without_suspects is not None
        and bool(change_of(verdicts, group, group.without_suspects))
        for group in verdicts.groups
    ]
    return [
        f"In {sum(groups)} of them the answer is another {what}."
        for groups, what in (
            (by_rule, f"by another rule for missing {verdicts.blocks}"),
            (plain, f"without suspect {verdicts.blocks}"),
        )
        if any(groups)
    ]


def _beyond_baseline(verdicts: Verdicts, group: Verdict) -> list[str]:
    """Return which methods differ from the baseline, where there is one."""
    if group.baseline is None or group.paired is None or not group.judged:
        return []
    sides: tuple[Literal["lower", "higher"], ...] = ("lower", "higher")
    named = {side: plain_names(verdicts, group.beyond_baseline(side)) for side in sides}
    differing = [f"{side}: {listed(names)}" for side, names in named.items() if names]
    (to,) = plain_names(verdicts, [group.baseline])
    start = f"{_start(verdicts, [group])}against {to}, {verdicts.metric.name} is "
    if not differing:
        return [f"{start}not significantly different for any method (p < {LEVEL:g})."]
    return [f"{start}significantly {'; '.join(differing)} (p < {LEVEL:g})."]


def _start(verdicts: Verdicts, same: Sequence[Verdict]) -> str:
    if len(verdicts.within) == 1:
        places = f"{verdicts.within[0]} {listed([group.labels[0] for group in same])}"
    else:
        every = range(len(verdicts.within))
        places = "; ".join(group_title(verdicts, group, every) for group in same)
    return start_text(places)


def _valued(values: Sequence[float], unit: str) -> str:
    """Return numbers from first to last with their unit; shares in percent."""
    texts = dict.fromkeys(f"{scale_of(unit) * value:.3g}" for value in values)
    return f"{' to '.join(texts)} {unit_text(unit)}".rstrip()
