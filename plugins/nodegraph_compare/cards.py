"""A card per group of a comparison: its verdict, its picture, and what it rests on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.left_out import narrowed
from nodegraph_compare.question import EXTREME
from nodegraph_compare.words import (
    UNCLEAR,
    behind_text,
    beside_text,
    change_of,
    change_text,
    changes,
    count_text,
    group_title,
    method_words,
    next_text,
    not_certain,
    over_all_text,
    plain_names,
    reason_text,
    scope_text,
    signed,
    units_text,
)
from nodegraph_tables.answer import (
    HERE,
    Card,
    Line,
    Text,
    Word,
    dot,
    few,
    joined,
    listing,
    say,
    svg,
)
from nodegraph_tables.numbers import MINUS, number_text, percent, span_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from nodegraph_compare.verdict import Verdict, Verdicts

_MOST_NAMES = 3
_MOST_SPOKEN = 20
_ORDER = ("rest", "before", "tied", "worse", "best")

_APART = 4.0
"""Across in pixels: nearer dots hide each other."""

Fact = tuple[str, Text]


def cards_of(verdicts: Verdicts) -> tuple[Card, ...]:
    """Return a card for each group; none where no mean is known."""
    line = line_of(verdicts)
    if line is None:
        return ()
    return tuple(_card(verdicts, group, line) for group in verdicts.groups)


def line_on_all(verdicts: Verdicts, overall: Verdict) -> str:
    """Return the verdict over all groups in words."""
    title = f"all {len(verdicts.groups)} groups"
    facts = tuple(_rows(verdicts, overall))
    return replace(_winner(verdicts, overall), title=title, facts=facts).line


def line_of(verdicts: Verdicts) -> Line | None:
    """Return the line that all cards share; None where no mean is known."""
    means = np.concatenate([group.mean for group in verdicts.groups] or [np.empty(0)])
    means = means[np.isfinite(means)]
    if not len(means):
        return None
    return Line.through(means.tolist(), log=verdicts.metric.better != "none")


def _card(verdicts: Verdicts, group: Verdict, line: Line) -> Card:
    title = group_title(verdicts, group)
    picture = _strip(verdicts, group, line) if len(group.known) > 1 else ""
    rows = (*_rows(verdicts, group), *_baseline(verdicts, group))
    facts = (*rows, *_beside(verdicts, group), *_grounds(verdicts, group))
    return replace(_winner(verdicts, group), title=title, picture=picture, facts=facts)


def _winner(verdicts: Verdicts, group: Verdict) -> Card:
    """Return the head of a card: the best with its mean, or why there is none."""
    known = group.known
    if not known:
        return Card("", ("no numbers",), aside=("no block has a number for every method",))
    if len(known) == 1:
        return Card("", listing(method_words(verdicts, known)), *_value(verdicts, group, known[0]))
    if verdicts.is_sequence:
        unit = verdicts.metric.unit
        first, last = (number_text(float(group.mean[known[at]]), unit) for at in (0, -1))
        begin, end = method_words(verdicts, [known[0], known[-1]])
        aside = say(f"{HERE}, from {first} {HERE}", end, begin)
        return Card("", (Word(last, "number"),), aside=aside)
    if verdicts.metric.better == "none":
        ends = [int(np.nanargmin(group.mean)), int(np.nanargmax(group.mean))]
        span = span_text([group.mean[end] for end in ends], verdicts.metric.unit)
        aside = say(f"{span}, from {HERE} to {HERE}", *method_words(verdicts, ends))
        return Card("", ("no better end",), aside=aside)
    best = listing(method_words(verdicts, group.best))
    value, interval = _value(verdicts, group, group.best[0])
    if group.told:
        return Card("", best, value, interval, best=bool(group.marks))
    why = "none clearly best" if group.stands else "no verdict"
    if group.stands:
        names = listing(method_words(verdicts, group.best))
        lowest = say(f"{EXTREME[verdicts.metric.better]}: {HERE} {HERE}", names, value)
        return Card("", (why,), aside=lowest)
    reason = reason_text(verdicts, group)
    others = [each for each in verdicts.groups if each.known and each is not group]
    reasons = {None if each.told or each.stands else reason_text(verdicts, each) for each in others}
    # a reason that all cards share stands once, in the answer above them
    return Card("", (why,), aside=() if reasons == {reason} else (reason,))


def _value(verdicts: Verdicts, group: Verdict, place: int) -> tuple[Text, Text]:
    """Return the mean of a method, and its interval."""
    unit = verdicts.metric.unit
    low, high = float(group.low[place]), float(group.high[place])
    between = span_text([low, high], "share" if unit == "share" else "")
    # one without width in the digits shown says nothing
    shown = np.isfinite(low) and " to " in between
    interval: Text = (Word(f"95 %: {between}", "number"),) if shown else ()
    return (Word(number_text(float(group.mean[place]), unit), "number"),), interval


def _strip(verdicts: Verdicts, group: Verdict, line: Line) -> str:
    """Return the dots of one group: the best filled, those not certain to be worse as rings."""
    metric = verdicts.metric
    known = group.known
    kinds = dict.fromkeys(known, "rest") | _kinds(verdicts, group)
    # the best is drawn last, above what it covers
    order = sorted(known, key=lambda place: _ORDER.index(kinds[place]))
    across = {place: line.at(float(group.mean[place])) for place in known}
    down = _heights(across)
    best = [(across[place], down[place]) for place in known if kinds[place] == "best"]

    def radius(place: int) -> float:
        # a ring is seen around the best that covers it
        if kinds[place] == "tied" and any(
            down[place] == y and abs(across[place] - x) < _APART for x, y in best
        ):
            return 7.0
        return 4.0 if kinds[place] == "rest" else 5.0

    dots = [
        dot(
            across[place], down[place], kinds[place],
            f"{verdicts.methods[place]} {number_text(float(group.mean[place]), metric.unit)}",
            radius(place), str(verdicts.methods[place]),
        )
        for place in order
    ]  # fmt: skip
    names = ", ".join(
        f"{verdicts.methods[place]} {number_text(float(group.mean[place]))}"
        for place in sorted(known, key=lambda place: group.mean[place])[:_MOST_SPOKEN]
    )
    name = f"mean {metric.name} of {len(known)} methods: {names}"
    return svg(name, 40.0, (line.drawn(22.0, metric.unit), *dots))


def _heights(across: Mapping[int, float]) -> dict[int, float]:
    """Return how far down dots are; of those in one place, every other one is higher."""
    heights: dict[int, float] = {}
    before, is_high = -np.inf, False
    for place in sorted(across, key=across.__getitem__):
        is_high = not is_high and across[place] - before < _APART
        heights[place], before = 3.0 if is_high else 12.0, across[place]
    return heights


def _kinds(verdicts: Verdicts, group: Verdict) -> dict[int, str]:
    """Return what the dots of a group are, apart from the rest."""
    if not group.stands:
        return {}
    if not verdicts.is_sequence:
        return ({} if group.baseline is None else {group.baseline: "before"}) | dict(group.marks)
    better = "raises" if verdicts.metric.better == "higher" else "lowers"
    steps = changes(group)
    return {min(each for each, _ in steps.values()): "before"} | {
        step: "best" if verb == better else "worse"
        for step, (_, verb) in steps.items()
        if verb != UNCLEAR
    }


def _rows(verdicts: Verdicts, group: Verdict) -> Iterator[Fact]:
    """Yield the methods that are not certain to be worse than the best, and those that are."""
    if len(group.known) < 2 or verdicts.metric.better == "none":
        return
    if not group.stands:
        best = listing(method_words(verdicts, group.best))
        end = EXTREME[verdicts.metric.better].capitalize()
        yield end, joined(" ", [best, joined(", ", _value(verdicts, group, group.best[0]))])
        return
    if verdicts.is_sequence:
        yield from _step_rows(verdicts, group)
        return
    if over_all := over_all_text(verdicts, group):
        yield "Best over all", over_all
    if group.told:
        tied, behind = (
            [place for place in places if place != verdicts.best_over_all]
            for places in (group.tied, group.behind)
        )
        if tied:
            yield "Not certain", not_certain(verdicts, group, tied)
        if behind:
            yield "Behind", _behind(verdicts, group, behind)
    elif group.tied and not over_all:
        yield "Next", next_text(verdicts, group)


def _step_rows(verdicts: Verdicts, group: Verdict) -> Iterator[Fact]:
    """Yield the effect of each step on the mean."""
    for step, (before, verb) in changes(group).items():
        mean = span_text([group.mean[step]], verdicts.metric.unit)
        by = change_text(verdicts, group, before, step)
        sign = MINUS if group.mean[step] < group.mean[before] else "+"
        clear = ", not clearly" * (verb == UNCLEAR)
        yield str(verdicts.methods[step]), (Word(f"{mean}, {sign}{by}", "number"), clear)


def _behind(verdicts: Verdicts, group: Verdict, places: Sequence[int]) -> Text:
    nearest = min(places, key=lambda place: abs(group.to_best_of(place)))
    distance = behind_text(verdicts, group, nearest)
    count = len(places)
    if count > 1 and count == len(group.known) - len(group.best):
        every = "both" if count == 2 else f"all {count}"
        return say(f"{every} others, next best: {HERE}", distance)
    rest = f" and {count - 1} more" if count > 1 else ""
    return say(f"{HERE}{rest}", distance)


def _baseline(verdicts: Verdicts, group: Verdict) -> Iterator[Fact]:
    """Yield the number of the baseline, and how far it is from the best."""
    place = group.baseline
    if place is None or not group.told or verdicts.is_sequence or place in group.best:
        return
    mean, best = float(group.mean[place]), float(group.mean[group.best[0]])
    sign = "+" if mean > best else MINUS
    share = f" ({sign}{percent(abs(mean / best - 1))})" if verdicts.ratio and best > 0 else ""
    number = number_text(mean, verdicts.metric.unit)
    yield str(verdicts.methods[place]), (Word(f"{number}{share}", "number"),)


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
    tied = f"not certain: {', '.join(close[:_MOST_NAMES])}" if close else ""
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
        unit, best = verdicts.metric.unit, float(other.mean[other.best[0]])
        by = signed(abs(other.to_best_of(group.best[0])), unit, best).removeprefix("+")
        ahead = Word(by, "number")
        text = f"{HERE}; without them {HERE} {HERE}, {HERE} ahead of {before}"
        return say(text, count, names, mean, ahead)
    end = EXTREME[verdicts.metric.better]
    text = f"{HERE}; without them {end}: {HERE} {HERE}, not certain either"
    return say(text, count, names, mean)
