"""The verdicts of a comparison at a glance: a card per group, or a grid of winners."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup, escape

from nodegraph_compare.question import EXTREME
from nodegraph_compare.words import (
    UNCLEAR,
    beside_text,
    both,
    change_text,
    changes,
    count_text,
    few,
    group_title,
    has_panels,
    in_unit,
    legend,
    method_names,
    reason_text,
    scope_sentences,
    sentences,
    signed,
    varying,
)
from nodegraph_tables.lead import MOST_CARDS, Card, Line, cards_html, dot, sentence_html, svg
from nodegraph_tables.numbers import MINUS, number_text, percent, span_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph_compare.verdict import Verdict, Verdicts

_MOST_COLUMNS = 6
_MOST_NAMES = 3
_MOST_ROWS = 60
_MOST_SPOKEN = 20
_ORDER = ("rest", "before", "tied", "worse", "best")


def answer_html(verdicts: Verdicts, name: str, meanings: Mapping[str, str]) -> str:
    """Return the answer and the verdicts of all groups.

    Up to eight groups have a card each, of which a reader sees those of one label of the first
    axis where there are more than four, with an answer of their own; more groups stand in a grid.

    Parameters
    ----------
    verdicts
        Of the comparison.
    name
        Distinguishes its parts from those of another on one page.
    meanings
        What the labels of an axis are.
    """
    line = _line_of(verdicts)
    groups = verdicts.groups
    answers = [sentence_html(Markup(answer)) for answer in sentences(verdicts).values()]
    if line is None:
        return answers[0]
    if len(groups) > MOST_CARDS:
        return answers[0] + _grid(verdicts)
    cards = [_card(verdicts, group, line) for group in groups]
    if has_panels(verdicts):
        return _tabs(verdicts, cards, answers, name, meanings)
    return answers[0] + cards_html(cards)


def _tabs(
    verdicts: Verdicts,
    cards: Sequence[Card],
    answers: Sequence[str],
    name: str,
    meanings: Mapping[str, str],
) -> str:
    """Return cards behind a radio button per label, which needs no script."""
    axis = varying(verdicts)[0]
    labels = list(dict.fromkeys(group.labels[axis] for group in verdicts.groups))
    axis_name = escape(verdicts.within[axis])
    buttons, panels = [], []
    for at, label in enumerate(labels):
        tab = f"{escape(name)}-{axis_name}-{at}"
        checked = " checked" * (at == 0)
        text = escape(str(label))
        buttons.append(
            f'<input type="radio" name="{escape(name)}-{axis_name}" id="{tab}"{checked}>'
            f'<label for="{tab}">{text}</label>'
        )
        inside = cards_html(
            [
                card
                for card, group in zip(cards, verdicts.groups, strict=True)
                if group.labels[axis] == label
            ]
        )
        panels.append(
            f'<div class="lead-panel"><p class="lead-label">{axis_name} {text}</p>'
            f"{answers[at]}{inside}</div>"
        )
    meaning = meanings.get(verdicts.within[axis], "")
    title = f' title="{escape(meaning)}"' if meaning else ""
    return (
        f'<div class="lead-tabs" role="group" aria-label="{axis_name}">'
        f'<span class="lead-axis"{title}>{axis_name}</span>'
        f"{''.join(buttons)}{''.join(panels)}</div>"
    )


def _card(verdicts: Verdicts, group: Verdict, line: Line) -> Card:
    axes = varying(verdicts)[int(has_panels(verdicts)) :]
    title = group_title(verdicts, group, axes)
    picture = _strip(verdicts, group, line) if len(group.known) > 1 else ""
    facts = [*_beside(verdicts, group), *_rows(verdicts, group), *_suspect_row(verdicts, group)]
    return replace(
        _winner(verdicts, group),
        title=title,
        picture=picture,
        facts=tuple((term, Markup(text)) for term, text in facts),
    )


def _winner(verdicts: Verdicts, group: Verdict) -> Card:
    """Return the head of a card: the best with its mean, or why there is none."""
    known = group.known
    if verdicts.is_sequence and len(known) > 1:
        unit = verdicts.metric.unit
        first, last = (number_text(float(group.mean[known[at]]), unit) for at in (0, -1))
        begin, end = (verdicts.methods[known[at]] for at in (0, -1))
        return Card("", last, aside=f"{end}, from {first} {begin}")
    if not known:
        return Card("", "no numbers", "", "no block has a number for every method")
    if len(known) == 1:
        names = " ".join(method_names(verdicts, known[:1]))
        value, interval = _value(verdicts, group, known[0])
        return Card("", Markup(names), value, interval)
    if verdicts.metric.better == "none":
        ends = [int(np.nanargmin(group.mean)), int(np.nanargmax(group.mean))]
        low, high = method_names(verdicts, ends)
        span = in_unit([group.mean[end] for end in ends], verdicts.metric.unit)
        return Card("", "no better end", aside=Markup(f"{span}, from {low} to {high}"))
    if not group.stands:
        return Card("", "no verdict", aside=reason_text(verdicts, group))
    best = both(method_names(verdicts, group.best))
    value, interval = _value(verdicts, group, group.best[0])
    if not group.told:
        first = f"{EXTREME[verdicts.metric.better]}: {best} {escape(value)}"
        return Card("", "none clearly best", aside=Markup(first))
    return Card("", Markup(best), value, interval, best=True)


def _value(verdicts: Verdicts, group: Verdict, place: int) -> tuple[str, str]:
    """Return the mean of a method, and its interval."""
    unit = verdicts.metric.unit
    low, high = float(group.low[place]), float(group.high[place])
    between = span_text([low, high], "share" if unit == "share" else "")
    interval = f"95 %: {between}" if np.isfinite(low) else ""
    return number_text(float(group.mean[place]), unit), interval


def _line_of(verdicts: Verdicts) -> Line | None:
    """Return the line that all cards share; None where no mean is known."""
    means = np.concatenate([group.mean for group in verdicts.groups] or [np.empty(0)])
    means = means[np.isfinite(means)]
    if not len(means):
        return None
    low, high = float(means.min()), float(means.max())
    # shares of 0 have no logarithm; with them the line is an ordinary one
    return Line(low, high, log=low > 0 and verdicts.metric.better != "none")


def _strip(verdicts: Verdicts, group: Verdict, line: Line) -> str:
    """Return the dots of one group: the best filled, those not clearly apart from it as rings."""
    metric = verdicts.metric
    known = group.known
    kinds = dict.fromkeys(known, "rest") | _kinds(verdicts, group)
    # the best is drawn last, above what it covers
    order = sorted(known, key=lambda place: _ORDER.index(kinds[place]))
    dots = [
        dot(
            line.at(mean := float(group.mean[place])), 10.0, kinds[place],
            f"{verdicts.methods[place]} {number_text(mean, metric.unit)}",
            4.0 if kinds[place] == "rest" else 5.0, str(verdicts.methods[place]),
        )
        for place in order
    ]  # fmt: skip
    names = ", ".join(
        f"{verdicts.methods[place]} {number_text(float(group.mean[place]))}"
        for place in sorted(known, key=lambda place: group.mean[place])[:_MOST_SPOKEN]
    )
    name = f"mean {metric.name} of {len(known)} methods: {names}"
    return svg(name, 40.0, (line.drawn(22.0, metric.unit), *dots))


def _kinds(verdicts: Verdicts, group: Verdict) -> dict[int, str]:
    """Return what the dots of a group are, apart from the rest."""
    if not group.stands:
        return {}
    if not verdicts.is_sequence:
        return dict(group.marks)
    better = "raises" if verdicts.metric.better == "higher" else "lowers"
    steps = changes(group)
    return {min(each for each, _ in steps.values()): "before"} | {
        step: "best" if verb == better else "worse"
        for step, (_, verb) in steps.items()
        if verb != UNCLEAR
    }


def _beside(verdicts: Verdicts, group: Verdict) -> list[tuple[str, str]]:
    """Return what else is asked of the best: its mean of other columns, and those of the rest."""
    if not group.stands:
        return []
    rows = []
    for metric in verdicts.beside:
        means = group.beside[metric.name]
        others = np.delete(means, group.best[0])
        others = others[np.isfinite(others)]
        text = beside_text([means[group.best[0]]], metric)
        if len(others):
            text += f" (others {beside_text([others.min(), others.max()], metric)})"
        rows.append((metric.name, text))
    return rows


def _rows(verdicts: Verdicts, group: Verdict) -> list[tuple[str, str]]:
    """Return the text after the best: methods not clearly apart from it, and those behind."""
    if len(group.known) < 2 or verdicts.metric.better == "none":
        return []
    if not group.stands:
        best = both(method_names(verdicts, group.best))
        value, interval = _value(verdicts, group, group.best[0])
        end = EXTREME[verdicts.metric.better].capitalize()
        return [(end, f"{best} {', '.join(filter(None, [escape(value), escape(interval)]))}")]
    if verdicts.is_sequence:
        return _step_rows(verdicts, group)
    order = sorted(group.tied, key=lambda place: abs(group.to_best_of(place)))
    tied = ", ".join(method_names(verdicts, order[:_MOST_NAMES]))
    if order:
        more = f" and {len(order) - _MOST_NAMES} more" if len(order) > _MOST_NAMES else ""
        mean, farthest = float(group.mean[group.best[0]]), abs(group.to_best_of(order[-1]))
        reach = signed(farthest, verdicts.metric.unit, mean).removeprefix("+")
        tied += f"{more}, within {reach.removeprefix('under ')}"
    rows = [("Tied", tied or "none")]
    if group.behind:
        rows.append(("Behind", _behind(verdicts, group)))
    return rows


def _step_rows(verdicts: Verdicts, group: Verdict) -> list[tuple[str, str]]:
    """Return the effect of each step on the mean."""
    rows = []
    for step, (before, verb) in changes(group).items():
        mean = in_unit([group.mean[step]], verdicts.metric.unit)
        by = change_text(verdicts, group, before, step)
        sign = MINUS if group.mean[step] < group.mean[before] else "+"
        clear = ", not clearly" * (verb == UNCLEAR)
        rows.append((str(verdicts.methods[step]), f"{mean}, {sign}{by}{clear}"))
    return rows


def _behind(verdicts: Verdicts, group: Verdict) -> str:
    nearest = min(group.behind, key=lambda place: abs(group.to_best_of(place)))
    (name,) = method_names(verdicts, [nearest])
    difference, mean = group.to_best_of(nearest), float(group.mean[group.best[0]])
    share = f" ({percent(abs(difference / mean))})" if mean > 0 and verdicts.ratio else ""
    more = len(group.behind) - 1
    rest = f" and {more} more" if more else ""
    return f"{name} {signed(difference, verdicts.metric.unit, mean)}{share}{rest}"


def _suspect_row(verdicts: Verdicts, group: Verdict) -> list[tuple[str, str]]:
    other = group.without_suspects
    if other is None:
        return []
    several = count_text(len(group.suspects), verdicts.blocks)
    text = (
        f'<strong class="suspect">\N{WHITE DIAMOND} {len(group.suspects):,} of '
        f"{count_text(group.of_blocks, verdicts.blocks)}</strong>"
    )
    if not other.best:
        return [("Suspect", f"{text}; nothing can be said without {several}")]
    mean = in_unit([other.mean[other.best[0]]], verdicts.metric.unit)
    names = both(method_names(verdicts, other.best))
    verb = "lead" if len(other.best) > 1 else "leads"
    instead = "" if set(other.best) == set(group.best) else " instead"
    return [("Suspect", f"{text}; without them {names} {verb}{instead}, {mean}")]


def _grid(verdicts: Verdicts) -> str:
    """Return the best of every group in rows and columns, where there are many groups."""
    axes = varying(verdicts)
    last = axes[-1]
    tops = list(dict.fromkeys(group.labels[last] for group in verdicts.groups))
    if len(axes) < 2 or len(tops) > _MOST_COLUMNS:
        return _list(verdicts)
    cells = {
        (tuple(group.labels[axis] for axis in axes[:-1]), group.labels[last]): group
        for group in verdicts.groups
    }
    sides = list(dict.fromkeys(side for side, _ in cells))
    heads = "".join(
        f'<th scope="col">{escape(text)}</th>'
        for text in (
            *(verdicts.within[axis] for axis in axes[:-1]),
            *(f"{verdicts.within[last]} {top}" for top in tops),
        )
    )
    rows = [
        "".join(f'<th scope="row">{escape(str(label))}</th>' for label in side)
        + "".join(f"<td>{_cell(verdicts, cells.get((side, top)))}</td>" for top in tops)
        for side in sides
    ]
    return _table(heads, rows)


def _list(verdicts: Verdicts) -> str:
    names = (
        ", ".join(verdicts.within[axis] for axis in varying(verdicts)),
        "best",
        "not clearly apart",
    )
    heads = "".join(f'<th scope="col">{escape(name)}</th>' for name in names)
    rows = [
        f'<th scope="row">{escape(group_title(verdicts, group))}</th>'
        f"<td>{_cell(verdicts, group)}</td><td>{few(method_names(verdicts, group.tied))}</td>"
        for group in verdicts.groups
    ]
    return _table(heads, rows)


def _cell(verdicts: Verdicts, group: Verdict | None) -> str:
    if group is None or not group.known:
        return "\N{EN DASH}"
    if not group.best:
        return in_unit([np.nanmin(group.mean), np.nanmax(group.mean)], verdicts.metric.unit)
    names = both(method_names(verdicts, group.best))
    mean = in_unit([group.mean[group.best[0]]], verdicts.metric.unit)
    if not group.stands:
        return f"<small>no verdict; first: {names} {mean}</small>"
    if not group.told:
        return f"<small>none clearly best; first: {names} {mean}</small>"
    tied = f", {len(group.tied)} tied" if group.tied else ""
    return f"{names} <small>{mean}{tied}</small>"


def _table(heads: str, rows: Sequence[str]) -> str:
    body = "".join(f"<tr>{row}</tr>" for row in rows[:_MOST_ROWS])
    more = len(rows) - _MOST_ROWS
    rest = f'<p class="lead-scope">{more} more rows are in the table.</p>' if more > 0 else ""
    return (
        f'<figure class="table lead-grid"><table><thead><tr>{heads}</tr></thead>'
        f"<tbody>{body}</tbody></table></figure>{rest}"
    )


def scope_line(verdicts: Verdicts) -> str:
    """Return what the verdicts hold for, what the numbers are, and how the cards are read."""
    line = _line_of(verdicts)
    logarithmic = line is not None and line.log
    return scope_sentences(verdicts) + Markup(legend(verdicts, logarithmic=logarithmic))
