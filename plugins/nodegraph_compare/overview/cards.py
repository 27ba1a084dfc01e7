"""The verdicts of a comparison at a glance: a card per group, or a grid of winners."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup, escape

from nodegraph_compare.overview.sentence import sentences
from nodegraph_compare.overview.words import (
    MOST_CARDS,
    UNCLEAR,
    beside_text,
    both,
    change_text,
    changes,
    count_text,
    few,
    has_panels,
    in_unit,
    method_names,
    signed,
    strong,
    title_html,
    title_parts,
    unit_means,
    varying,
    why_none,
)
from nodegraph_compare.question import EXTREME
from nodegraph_tables.lead import Card, Line, cards_html, dot, sentence_html, svg
from nodegraph_tables.numbers import MINUS, number_text, percent, span_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph_compare.overview.value import GroupOverview, Overview

_MOST_COLUMNS = 6
_MOST_NAMES = 3
_MOST_ROWS = 60
_MOST_SPOKEN = 20
_ORDER = ("rest", "before", "tied", "worse", "best")


def verdicts(overview: Overview, name: str, meanings: Mapping[str, str]) -> str:
    """Return the answer and the verdicts of all groups.

    Up to eight groups have a card each, of which a reader sees those of one label of the first
    axis where there are more than four, with an answer of their own; more groups stand in a grid.

    Parameters
    ----------
    overview
        Of the comparison.
    name
        Distinguishes its parts from those of another on one page.
    meanings
        What the labels of an axis are.
    """
    line = _line_of(overview)
    groups = overview.groups
    answers = [sentence_html(Markup(answer)) for answer in sentences(overview).values()]
    if line is None:
        return answers[0]
    if len(groups) > MOST_CARDS:
        return answers[0] + _grid(overview)
    cards = [_card(overview, group, line) for group in groups]
    if has_panels(overview):
        return _tabs(overview, cards, answers, name, meanings)
    return answers[0] + cards_html(cards)


def _tabs(
    overview: Overview,
    cards: Sequence[Card],
    answers: Sequence[str],
    name: str,
    meanings: Mapping[str, str],
) -> str:
    """Return cards behind a radio button per label, which needs no script."""
    axis = varying(overview)[0]
    labels = list(dict.fromkeys(group.labels[axis] for group in overview.groups))
    axis_name = escape(overview.within[axis])
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
                for card, group in zip(cards, overview.groups, strict=True)
                if group.labels[axis] == label
            ]
        )
        panels.append(
            f'<div class="lead-panel"><p class="lead-label">{axis_name} {text}</p>'
            f"{answers[at]}{inside}</div>"
        )
    meaning = meanings.get(overview.within[axis], "")
    title = f' title="{escape(meaning)}"' if meaning else ""
    return (
        f'<div class="lead-tabs" role="group" aria-label="{axis_name}">'
        f'<span class="lead-axis"{title}>{axis_name}</span>'
        f"{''.join(buttons)}{''.join(panels)}</div>"
    )


def _card(overview: Overview, group: GroupOverview, line: Line) -> Card:
    title = ", ".join(title_parts(overview, group, skip=int(has_panels(overview))))
    several = np.count_nonzero(np.isfinite(group.mean)) > 1
    picture = _strip(overview, group, line) if several else ""
    facts = [*_beside(overview, group), *_rows(overview, group), *_suspect_row(overview, group)]
    return replace(
        _winner(overview, group),
        title=title,
        picture=picture,
        facts=tuple((term, Markup(text)) for term, text in facts),
    )


def _winner(overview: Overview, group: GroupOverview) -> Card:
    """Return the head of a card: the best with its mean, or why there is none."""
    known = np.flatnonzero(np.isfinite(group.mean))
    if overview.is_sequence and len(known) > 1:
        unit = overview.metric.unit
        first, last = (number_text(float(group.mean[known[at]]), unit) for at in (0, -1))
        begin, end = (overview.methods[known[at]] for at in (0, -1))
        return Card("", last, aside=f"{end}, from {first} {begin}")
    if not len(known):
        return Card("", "no numbers", "", "no block has a number for every method")
    if len(known) == 1:
        names = " ".join(method_names(overview, known[:1].tolist()))
        value, interval = _value(overview, group, int(known[0]))
        return Card("", Markup(names), value, interval, best=True)
    if overview.metric.better == "none":
        ends = [int(known[np.argmin(group.mean[known])]), int(known[np.argmax(group.mean[known])])]
        low, high = method_names(overview, ends)
        span = in_unit([group.mean[end] for end in ends], overview.metric.unit)
        return Card("", "no better end", aside=Markup(f"{span}, from {low} to {high}"))
    if not group.stands:
        return Card("", "no verdict", aside=why_none(group))
    best = both(method_names(overview, group.best))
    value, interval = _value(overview, group, group.best[0])
    return Card("", Markup(best), value, interval, best=True)


def _value(overview: Overview, group: GroupOverview, place: int) -> tuple[str, str]:
    """Return the mean of a method, and its interval."""
    unit = overview.metric.unit
    low, high = float(group.low[place]), float(group.high[place])
    between = span_text([low, high], "share" if unit == "share" else "")
    interval = f"95 %: {between}" if np.isfinite(low) else ""
    return number_text(float(group.mean[place]), unit), interval


def _line_of(overview: Overview) -> Line | None:
    """Return the line that all cards share; None where no mean is known."""
    means = np.concatenate([group.mean for group in overview.groups] or [np.empty(0)])
    means = means[np.isfinite(means)]
    if not len(means):
        return None
    low, high = float(means.min()), float(means.max())
    # shares of 0 have no logarithm; with them the line is an ordinary one
    return Line(low, high, log=low > 0 and overview.metric.better != "none")


def _strip(overview: Overview, group: GroupOverview, line: Line) -> str:
    """Return the dots of one group: the best filled, those not clearly apart from it as rings."""
    metric = overview.metric
    known = np.flatnonzero(np.isfinite(group.mean)).tolist()
    kinds = dict.fromkeys(known, "rest") | _kinds(overview, group)
    # the best is drawn last, above what it covers
    order = sorted(known, key=lambda place: _ORDER.index(kinds[place]))
    dots = [
        dot(
            line.at(mean := float(group.mean[place])), 10.0, kinds[place],
            f"{overview.methods[place]} {number_text(mean, metric.unit)}",
            4.0 if kinds[place] == "rest" else 5.0, str(overview.methods[place]),
        )
        for place in order
    ]  # fmt: skip
    names = ", ".join(
        f"{overview.methods[place]} {number_text(float(group.mean[place]))}"
        for place in sorted(known, key=lambda place: group.mean[place])[:_MOST_SPOKEN]
    )
    name = f"mean {metric.name} of {len(known)} methods: {names}"
    return svg(name, 40.0, (line.drawn(22.0, metric.unit), *dots))


def _kinds(overview: Overview, group: GroupOverview) -> dict[int, str]:
    """Return what the dots of a group are, apart from the rest."""
    if not group.stands:
        return {}
    if not overview.is_sequence:
        return dict.fromkeys(group.tied, "tied") | dict.fromkeys(group.best, "best")
    better = "raises" if overview.metric.better == "higher" else "lowers"
    steps = changes(group)
    return {min(each for each, _ in steps.values()): "before"} | {
        step: "best" if verb == better else "worse"
        for step, (_, verb) in steps.items()
        if verb != UNCLEAR
    }


def _beside(overview: Overview, group: GroupOverview) -> list[tuple[str, str]]:
    """Return what else is asked of the best: its mean of other columns, and those of the rest."""
    if not group.stands:
        return []
    rows = []
    for metric in overview.metrics[1 : 1 + overview.beside]:
        means = unit_means(group, metric.name)
        others = np.delete(means, group.best[0])
        others = others[np.isfinite(others)]
        text = beside_text([means[group.best[0]]], metric)
        if len(others):
            text += f" (others {beside_text([others.min(), others.max()], metric)})"
        rows.append((metric.name, text))
    return rows


def _rows(overview: Overview, group: GroupOverview) -> list[tuple[str, str]]:
    """Return the text after the best: methods not clearly apart from it, and those behind."""
    known = np.count_nonzero(np.isfinite(group.mean))
    if known < 2 or overview.metric.better == "none":
        return []
    if not group.stands:
        best = both(method_names(overview, group.best))
        value, interval = _value(overview, group, group.best[0])
        end = EXTREME[overview.metric.better].capitalize()
        return [(end, f"{best} {', '.join(filter(None, [escape(value), escape(interval)]))}")]
    if overview.is_sequence:
        return _step_rows(overview, group)
    order = sorted(group.tied, key=lambda place: abs(group.difference[place]))
    tied = ", ".join(method_names(overview, order[:_MOST_NAMES]))
    if order:
        more = f" and {len(order) - _MOST_NAMES} more" if len(order) > _MOST_NAMES else ""
        mean, farthest = float(group.mean[group.best[0]]), abs(float(group.difference[order[-1]]))
        reach = signed(farthest, overview.metric.unit, mean).removeprefix("+")
        tied += f"{more}, within {reach.removeprefix('under ')}"
    rows = [("Tied", tied or "none")]
    if group.behind:
        rows.append(("Behind", _behind(overview, group)))
    return rows


def _step_rows(overview: Overview, group: GroupOverview) -> list[tuple[str, str]]:
    """Return the effect of each step on the mean."""
    rows = []
    for step, (before, verb) in changes(group).items():
        mean = in_unit([group.mean[step]], overview.metric.unit)
        by = change_text(overview, group, before, step)
        sign = MINUS if group.mean[step] < group.mean[before] else "+"
        clear = ", not clearly" * (verb == UNCLEAR)
        rows.append((str(overview.methods[step]), f"{mean}, {sign}{by}{clear}"))
    return rows


def _behind(overview: Overview, group: GroupOverview) -> str:
    nearest = min(group.behind, key=lambda place: abs(group.difference[place]))
    (name,) = method_names(overview, [nearest])
    difference, mean = float(group.difference[nearest]), float(group.mean[group.best[0]])
    share = f" ({percent(abs(difference / mean))})" if mean > 0 and overview.ratio else ""
    more = len(group.behind) - 1
    rest = f" and {more} more" if more else ""
    return f"{name} {signed(difference, overview.metric.unit, mean)}{share}{rest}"


def _suspect_row(overview: Overview, group: GroupOverview) -> list[tuple[str, str]]:
    other = group.without_suspects
    if other is None:
        return []
    several = count_text(len(group.suspect), overview.blocks)
    text = (
        f'<strong class="suspect">\N{WHITE DIAMOND} {len(group.suspect):,} of '
        f"{count_text(len(group.unit), overview.blocks)}</strong>"
    )
    if not other.best:
        return [("Suspect", f"{text}; nothing can be said without {several}")]
    mean = in_unit([other.mean[other.best[0]]], overview.metric.unit)
    names = both(method_names(overview, other.best))
    verb = "lead" if len(other.best) > 1 else "leads"
    instead = "" if set(other.best) == set(group.best) else " instead"
    return [("Suspect", f"{text}; without them {names} {verb}{instead}, {mean}")]


def _grid(overview: Overview) -> str:
    """Return the best of every group in rows and columns, where there are many groups."""
    axes = varying(overview)
    last = axes[-1]
    tops = list(dict.fromkeys(group.labels[last] for group in overview.groups))
    if len(axes) < 2 or len(tops) > _MOST_COLUMNS:
        return _list(overview)
    cells = {
        (tuple(group.labels[axis] for axis in axes[:-1]), group.labels[last]): group
        for group in overview.groups
    }
    sides = list(dict.fromkeys(side for side, _ in cells))
    heads = "".join(
        f'<th scope="col">{escape(text)}</th>'
        for text in (
            *(overview.within[axis] for axis in axes[:-1]),
            *(f"{overview.within[last]} {top}" for top in tops),
        )
    )
    rows = [
        "".join(f'<th scope="row">{escape(str(label))}</th>' for label in side)
        + "".join(f"<td>{_cell(overview, cells.get((side, top)))}</td>" for top in tops)
        for side in sides
    ]
    return _table(heads, rows)


def _list(overview: Overview) -> str:
    names = (
        ", ".join(overview.within[axis] for axis in varying(overview)),
        "best",
        "not clearly apart",
    )
    heads = "".join(f'<th scope="col">{escape(name)}</th>' for name in names)
    rows = [
        f'<th scope="row">{title_html(overview, group)}</th><td>{_cell(overview, group)}</td>'
        f"<td>{few(method_names(overview, group.tied))}</td>"
        for group in overview.groups
    ]
    return _table(heads, rows)


def _cell(overview: Overview, group: GroupOverview | None) -> str:
    if group is None or not np.isfinite(group.mean).any():
        return "\N{EN DASH}"
    if not group.best:
        return in_unit([np.nanmin(group.mean), np.nanmax(group.mean)], overview.metric.unit)
    names = both(method_names(overview, group.best))
    mean = in_unit([group.mean[group.best[0]]], overview.metric.unit)
    if not group.stands:
        return f"<small>no verdict; first: {names} {mean}</small>"
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


def scope_line(overview: Overview) -> str:
    """Return what the verdicts hold for, what the numbers are, and how the cards are read."""
    return scope_sentences(overview) + Markup(_legend(overview))


def scope_sentences(overview: Overview) -> Markup:
    """Return what the verdicts hold for, and what the numbers are."""
    scopes = list(dict.fromkeys(group.scope for group in overview.groups if group.scope))
    metric = overview.metric
    first = scopes[0] if scopes else ""
    judged = any(group.stands for group in overview.groups)
    if first.startswith("over "):
        units = strong(f"Scope: {first.removeprefix('over ')}")
        what = "Holds" if judged else "Only the intervals hold"
        holds = f"{units}. {what} for further {escape(overview.units)}."
    elif first and not judged:
        holds = f"{strong('Scope')}: nothing is said {escape(first)}."
    elif first:
        holds = f"{strong('Scope')}: holds {escape(first)}, not for others."
    else:
        holds = ""
    cautions = Counter(g.caution for g in overview.groups if g.stands and g.caution)
    every = len(overview.groups)
    few = "".join(
        f" {escape(text[:1].upper() + text[1:])}"
        f"{'' if count == every else f' (in {count} of {every} groups)'}."
        for text, count in cautions.items()
    )
    end = "neither end is better" if metric.better == "none" else f"{metric.better} is better"
    unit = f" ({in_unit([], metric.unit).strip()})" if metric.unit else ""
    over = overview.units if first.startswith("over ") else overview.blocks
    numbers = f"Mean {escape(metric.name)}{unit} over {escape(over)}, {end}."
    return Markup(f"{holds}{few} {numbers}")


def _legend(overview: Overview) -> str:
    """Return what the dots of the cards are, and what tied means."""
    stands = [group for group in overview.groups if group.stands]
    if not stands or len(overview.groups) > MOST_CARDS or len(overview.methods) < 2:
        return ""
    if overview.is_sequence:
        return (
            f" Percentages: to the {escape(overview.compare)} before; dots: hollow where it begins,"
            " blue clearly better than before, orange clearly worse, grey not clearly changed."
        )
    tied = (
        f"; ringed: {strong('tied')}, paired differences cannot tell it from the best"
        if any(group.tied for group in stands)
        else ""
    )
    behind = "; grey: clearly behind" if any(group.behind for group in stands) else ""
    line = _line_of(overview)
    scale = ", on a logarithmic scale" if line is not None and line.log else ""
    return f" Dots: a method each{scale}; filled: the best{tied}{behind}."
