"""A card per group of a comparison: its verdict, its picture, and what it rests on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.left_out import narrowed
from nodegraph_compare.question import EXTREME
from nodegraph_compare.words import (
    UNCLEAR,
    beside_text,
    change_of,
    change_text,
    changes,
    count_text,
    group_words,
    method_words,
    nearest_first,
    plain_names,
    reason_text,
    reasons_of,
    scope_text,
    standing_text,
    uncertain_text,
    units_text,
    within_text,
)
from nodegraph_tables.answer import MAY_BE, MOST_CARDS, MOST_ROWS, ONE_ROW, Card, Row, Rows
from nodegraph_tables.line import Line, line_of
from nodegraph_tables.numbers import (
    MINUS,
    apart_text,
    is_seen,
    number_text,
    span_text,
    without_rounding,
)
from nodegraph_tables.style import bare_unit
from nodegraph_tables.text import HERE, Text, Word, few, listing, say

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from nodegraph_compare.verdict import Verdict, Verdicts
    from nodegraph_tables.answer import Kind

NO_DIFFERENCE = "no clear difference"
"""Said of methods of which the verdict tells none apart."""

_MOST_NAMES = 3
_FEW_ROWS = 4
"""On cards below each other, of which one may have a note."""

_BEYOND = 0.6
"""Share of the line of all means that the ends of intervals may be beyond it."""

Fact = tuple[str, Text]


def cards_of(verdicts: Verdicts) -> tuple[Card, ...]:
    """Return a card for each group; none where no mean is known."""
    return tuple(
        replace(
            card_of(verdicts, group, line),
            title=group_words(verdicts, group),
            facts=(*_beside(verdicts, group), *_grounds(verdicts, group)),
        )
        for group, line in zip(verdicts.groups, lines_of(verdicts), strict=False)
    )


def lines_of(verdicts: Verdicts) -> list[Line]:
    """Return the line of each card; none where no mean is known.

    On it are all means, and the ends of intervals that are not far beyond these. Cards share it;
    but a logarithmic one of more cards than stand in a row is of multiples of each card's least
    mean.
    """
    groups = verdicts.groups
    means, ends = _drawn(verdicts, groups)
    if not means:
        return []
    shared = line_of(means, ends, log=verdicts.metric.better != "none")
    if not shared.log or shared.least or len(groups) <= ONE_ROW:
        return [shared] * len(groups)
    are_cards = len(groups) <= MOST_CARDS  # which have intervals
    drawn = [_drawn(verdicts, [group]) for group in groups]
    ones = [min(of, default=min(means)) for of, _ in drawn]
    multiples = [
        each / one
        for one, (of, near) in zip(ones, drawn, strict=True)
        for each in (*of, *(near if are_cards else ()))
        if each > 0.0
    ]
    low, high = min(multiples), max(multiples)
    return [Line(low * one, high * one, log=True, one=one) for one in ones]


def _drawn(verdicts: Verdicts, groups: Sequence[Verdict]) -> tuple[list[float], list[float]]:
    """Return the means of groups, and the ends of intervals that are not far beyond these."""
    mean, low, high = (
        np.concatenate([getattr(group, name) for group in groups] or [np.empty(0)])
        for name in ("mean", "low", "high")
    )
    known = mean[np.isfinite(mean)]
    if not len(known):
        return [], []
    most = known.max() + _BEYOND * np.ptp(np.append(known, 0.0))
    least = known.min() - _BEYOND * np.ptp(known)
    if verdicts.ratio:
        least = known.min() * (1.0 - _BEYOND)
    return known.tolist(), [*low[low >= least].tolist(), *high[high <= most].tolist()]


def card_of(verdicts: Verdicts, group: Verdict, line: Line) -> Card:
    """Return the best of a group with its mean, or why there is none, and a row per method."""
    known = group.known
    if not known:
        return Card((), ("no numbers",), aside=("no block has a number for every method",))
    if len(known) == 1:
        return Card((), listing(method_words(verdicts, known)), *_value(verdicts, group, known[0]))
    rows = _rows(verdicts, group, line)
    if verdicts.is_sequence:
        first, last = known[0], known[-1]
        change: Text = (Word(_change(verdicts, group, first, last), "number"),)
        if not _is_seen(verdicts, group, last, first):
            change = ("hardly changed",)
        ends = span_text([group.mean[first], group.mean[last]], verdicts.metric.unit)
        arrow = ends.replace(" to ", " \N{RIGHTWARDS ARROW} ")
        return Card((), change, (Word(arrow, "number"),), rows=rows)
    if verdicts.metric.better == "none":
        return Card((), (), rows=rows)
    if group.told:
        return _told(verdicts, group, rows)
    if group.stands:
        return Card((), (NO_DIFFERENCE,), rows=rows)
    every = [each for each in verdicts.groups if each.known]
    reasons = reasons_of(verdicts, (each for each in every if not each.stands))
    # a reason that all cards share stands once, in the answer above them
    is_shared = len(every) > 1 == len(reasons) and not any(each.stands for each in every)
    reason = () if is_shared else (reason_text(verdicts, group),)
    return Card((), ("no verdict",), aside=reason, rows=rows)


def _told(verdicts: Verdicts, group: Verdict, rows: Rows) -> Card:
    """Return the best of the group, and how others stand to it."""
    value, interval = _value(verdicts, group, group.best[0])
    names = listing(method_words(verdicts, group.best))
    status = standing_text(without_unit(verdicts), group)
    kind: Kind = group.marks.get(group.best[0], "rest")
    return Card((), names, value, interval, rows=rows, status=status, kind=kind)


def _is_seen(verdicts: Verdicts, group: Verdict, place: int, to: int) -> bool:
    """Whether the numbers of two methods look different to a reader."""
    return is_seen(float(group.mean[place]), float(group.mean[to]), verdicts.metric.unit)


def _value(verdicts: Verdicts, group: Verdict, place: int) -> tuple[Text, Text]:
    """Return the mean of a method, and its interval."""
    unit = verdicts.metric.unit
    low, high = float(group.low[place]), float(group.high[place])
    between = span_text([low, high], bare_unit(unit))
    # one without width in the digits shown says nothing
    shown = np.isfinite(low) and " to " in between
    interval: Text = (Word(f"95 %: {between}", "number"),) if shown else ()
    return (Word(number_text(float(group.mean[place]), unit), "number"),), interval


def _rows(verdicts: Verdicts, group: Verdict, line: Line) -> Rows:
    """Return a row for each method, from the best to the worst."""
    described = verdicts.is_sequence or verdicts.metric.better == "none"
    ranked = [place for place in group.ranked if place in group.known]
    is_below = len(verdicts.groups) > ONE_ROW
    is_one = is_below or group.told
    kinds, notes = kinds_of(verdicts, group), _notes(verdicts, group, 1 if is_one else _MOST_NAMES)
    means = without_rounding(group.mean.tolist())
    rows = [
        Row(
            str(verdicts.methods[place]),
            means[place],
            float(group.low[place]),
            float(group.high[place]),
            kinds.get(place, "rest"),
            notes.get(place, ()),
            for_all=place == verdicts.for_all,
        )
        for place in (group.known if described else ranked)
    ]
    return Rows.of(rows, line, verdicts.metric.unit, _FEW_ROWS if is_below else MOST_ROWS)


def kinds_of(verdicts: Verdicts, group: Verdict) -> dict[int, Kind]:
    """Return what the dots of a group are, apart from the rest."""
    kinds: dict[int, Kind] = {}
    if verdicts.metric.better == "none" or (verdicts.is_sequence and not group.stands):
        return kinds
    if not verdicts.is_sequence:
        if not group.told:
            kinds = dict.fromkeys(group.known, "open")
        if group.stands and group.baseline is not None:
            kinds[group.baseline] = "before"
        return kinds | dict(group.marks)
    better = "raises" if verdicts.metric.better == "higher" else "lowers"
    for step, (before, verb) in changes(group).items():
        kinds.setdefault(before, "rest" if kinds else "before")
        if verb != UNCLEAR and _is_seen(verdicts, group, step, before):
            kinds[step] = "best" if verb == better else "worse"
    return kinds


def _notes(verdicts: Verdicts, group: Verdict, most: int) -> dict[int, Text]:
    """Return how far the nearest methods are from the best that are not certain to be worse.

    Where there is no best, how far they are from a baseline.
    """
    if verdicts.is_sequence:
        return _step_notes(verdicts, group)
    bare, paired = without_unit(verdicts), group.to_best if group.best else group.to_baseline
    if paired is None or (group.best and not group.stands):
        return {}
    others = [place for place in group.known if place != paired.reference]
    start = f"difference to {verdicts.methods[paired.reference]}: {HERE}"
    if group.best:
        others = nearest_first(group, group.tied)
        start = f"from the {EXTREME[group.better]}: {HERE}"
    if group.told:
        return {place: uncertain_text(bare, group, place) for place in others[:most]}
    return {place: say(start, within_text(bare, group, place, paired)) for place in others[:most]}


def without_unit(verdicts: Verdicts) -> Verdicts:
    """Return verdicts whose numbers have no unit, but for shares, as it stands beside them."""
    metric = verdicts.metric
    return replace(verdicts, metric=replace(metric, unit=bare_unit(metric.unit)))


def _step_notes(verdicts: Verdicts, group: Verdict) -> dict[int, Text]:
    """Return the effect of each step on the mean."""
    notes: dict[int, Text] = {}
    for step, (before, verb) in changes(group).items():
        size = Word(_change(verdicts, group, before, step), "number")
        notes[step] = (size, ", not clearly" * (verb == UNCLEAR))
        if not _is_seen(verdicts, group, step, before):
            notes[step] = ("hardly changed",)
    return notes


def _change(verdicts: Verdicts, group: Verdict, before: int, step: int) -> str:
    sign = MINUS if group.mean[step] < group.mean[before] else "+"
    return f"{sign}{change_text(verdicts, group, before, step)}"


def _beside(verdicts: Verdicts, group: Verdict) -> Iterator[Fact]:
    """Yield what else is asked: means of other columns, of the best."""
    for metric in verdicts.beside if group.stands else ():
        mean = group.beside[metric.name][group.best[0]]
        yield metric.name, (Word(beside_text(verdicts, [mean], metric), "number"),)


def _grounds(verdicts: Verdicts, group: Verdict) -> Iterator[Fact]:
    """Yield what a verdict rests on: blocks that are left out or doubted, further claims."""
    if left := _left(verdicts, group):
        yield "Used", (left,)
    if group.judged and verdicts.margin is not None and group.paired is not None:
        yield "Equal", (_equal(verdicts, group),)
    if group.next_minutes is not None and group.next_minutes.scope.shortage is None:
        yield "Next minutes", (_next_minutes(verdicts, group.next_minutes),)
    if group.without_suspects is not None and group.suspects_matter:
        yield "Suspect", _suspect(verdicts, group, group.without_suspects)
    if group.not_compared and group.known:
        yield "Absent", few(method_words(verdicts, group.not_compared), _MOST_NAMES)


def _left(verdicts: Verdicts, group: Verdict) -> str:
    usable = [place for place in group.ranked if group.lacking[place] < group.of_blocks]
    lacking = [(verdicts.methods[p], int(group.lacking[p])) for p in sorted(usable)]
    used = int(group.blocks.max(initial=0)) if usable else group.of_blocks
    return narrowed(lacking, used, group.of_blocks, verdicts.blocks)


def _equal(verdicts: Verdicts, group: Verdict) -> str:
    """Return which methods are practically equal to what they are compared to."""
    paired = group.paired
    assert paired is not None
    names = plain_names(verdicts, group.equal)
    (to,) = plain_names(verdicts, [paired.reference])
    if names:
        return f"to {to} within {verdicts.margin}: {', '.join(names)}"
    place = int(np.nanargmin(paired.margin))
    (nearest,) = plain_names(verdicts, [place])
    shown = f"{nearest} within {paired.margin[place]:.3g}"
    return f"none is shown to be equal to {to} within {verdicts.margin} (nearest: {shown})"


def _next_minutes(verdicts: Verdicts, group: Verdict) -> str:
    """Return what the segments of a recording say, beside its repetitions."""
    close, behind = plain_names(verdicts, group.tied), len(group.behind)
    tied = f"{MAY_BE}: {', '.join(close[:_MOST_NAMES])}" if close else ""
    apart = f"{behind} clearly behind" if behind else ""
    said = "; ".join(filter(None, [tied, apart])) or "nothing is apart"
    return f"{said} {scope_text(group.scope)} ({units_text(group.scope)})"


def _suspect(verdicts: Verdicts, group: Verdict, other: Verdict) -> Text:
    several = count_text(len(group.suspects), verdicts.blocks)
    text = (
        f"\N{WHITE DIAMOND} {len(group.suspects):,} of "
        f"{count_text(group.of_blocks, verdicts.blocks)}"
    )
    count = Word(text, "suspect")
    if not other.best:
        return say(f"{HERE}; nothing can be said without {several}", count)
    mean = Word(span_text([other.mean[other.best[0]]], verdicts.metric.unit), "number")
    if set(other.best) == set(group.best):
        return say(f"{HERE}; without them {HERE}; {change_of(verdicts, group, other)}", count, mean)
    names = listing(method_words(verdicts, other.best))
    if group.suspects_decide:
        (before,) = plain_names(verdicts, group.best[:1])
        means = [float(other.mean[each]) for each in (group.best[0], other.best[0])]
        ahead = Word(apart_text(means, verdicts.metric.unit), "number")
        text = f"{HERE}; without them {HERE} {HERE}, {HERE} ahead of {before}"
        return say(text, count, names, mean, ahead)
    end = EXTREME[verdicts.metric.better]
    text = f"{HERE}; without them {end}: {HERE} {HERE}, which others may equal"
    return say(text, count, names, mean)
