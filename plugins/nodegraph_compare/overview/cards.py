"""The verdicts of a comparison at a glance: a card per group, or a grid of winners."""

from __future__ import annotations

from collections import Counter
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.overview.sentence import sentences
from nodegraph_compare.overview.strip import axis_of, strip
from nodegraph_compare.overview.words import (
    MOST_CARDS,
    both,
    count_text,
    few,
    has_panels,
    in_unit,
    method_names,
    percent,
    signed,
    strong,
    title_html,
    title_parts,
    varying,
    why_none,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.overview.strip import Axis
    from nodegraph_compare.overview.value import GroupOverview, Overview

_MOST_COLUMNS = 6
_MOST_ROWS = 60


def verdicts(overview: Overview, name: str) -> str:
    """Return the answer and the verdicts of all groups.

    Up to eight groups have a card each, of which a reader sees those of one label of the first
    axis where there are more than four, with an answer of their own; more groups stand in a grid.

    Parameters
    ----------
    overview
        Of the comparison.
    name
        By which its parts are told from those of another on one page.
    """
    axis = axis_of(overview)
    groups = overview.groups
    answers = [
        f'<p class="overview-sentence">{answer}</p>' for answer in sentences(overview).values()
    ]
    if axis is None:
        return answers[0]
    if len(groups) > MOST_CARDS:
        return answers[0] + _grid(overview)
    cards = [_card(overview, group, at, axis) for at, group in enumerate(groups)]
    if has_panels(overview):
        return _tabs(overview, cards, answers, name)
    return f'{answers[0]}<div class="overview-cards">{"".join(cards)}</div>'


def _tabs(overview: Overview, cards: Sequence[str], answers: Sequence[str], name: str) -> str:
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
        inside = "".join(
            card
            for card, group in zip(cards, overview.groups, strict=True)
            if group.labels[axis] == label
        )
        panels.append(
            f'<div class="overview-panel"><p class="overview-label">{axis_name} {text}</p>'
            f'{answers[at]}<div class="overview-cards">{inside}</div></div>'
        )
    return (
        f'<div class="overview-tabs" role="group" aria-label="{axis_name}">'
        f'<span class="overview-axis">{axis_name}</span>{"".join(buttons)}{"".join(panels)}</div>'
    )


def _card(overview: Overview, group: GroupOverview, at: int, axis: Axis) -> str:
    title = escape(", ".join(title_parts(overview, group, skip=int(has_panels(overview)))))
    head = f'<h3 aria-level="2">{title}</h3>' if title else ""
    rows = [*_rows(overview, group), *_suspect_row(overview, group)]
    facts = "".join(f"<dt>{term}</dt><dd>{text}</dd>" for term, text in rows)
    several = np.count_nonzero(np.isfinite(group.mean)) > 1
    return (
        f'<article class="overview-card" data-group="{at}">{head}{_winner(overview, group)}'
        f"{strip(overview, group, axis) if several else ''}"
        f"{f'<dl>{facts}</dl>' if facts else ''}</article>"
    )


def _winner(overview: Overview, group: GroupOverview) -> str:
    """Return what heads a card: the best with its mean, or why there is none."""
    known = np.flatnonzero(np.isfinite(group.mean))
    if not len(known):
        return _headline("no numbers", "no block has a number for every method")
    if len(known) == 1:
        return _headline(
            " ".join(method_names(overview, known[:1].tolist())),
            _value(overview, group, int(known[0])),
            best=True,
        )
    if overview.metric.better == "none":
        ends = [int(known[np.argmin(group.mean[known])]), int(known[np.argmax(group.mean[known])])]
        low, high = method_names(overview, ends)
        span = in_unit([group.mean[end] for end in ends], overview.metric.unit)
        return _headline("no better end", f"{span}, from {low} to {high}")
    if not group.stands:
        return _headline("no verdict", escape(why_none(group)))
    best = both(method_names(overview, group.best))
    return _headline(best, _value(overview, group, group.best[0]), best=True)


def _headline(text: str, below: str, *, best: bool = False) -> str:
    kind = "overview-winner" if best else "overview-winner overview-none"
    return f'<p class="{kind}">{text}</p><p class="overview-value">{below}</p>'


def _value(overview: Overview, group: GroupOverview, place: int) -> str:
    unit = overview.metric.unit
    low, high = float(group.low[place]), float(group.high[place])
    between = in_unit([low, high], "share" if unit == "share" else "")
    interval = f" <small>95 %: {between}</small>" if np.isfinite(low) else ""
    return f"<b>{in_unit([group.mean[place]], unit)}</b>{interval}"


def _rows(overview: Overview, group: GroupOverview) -> list[tuple[str, str]]:
    """Return what follows the best: what is not clearly apart from it, and what is behind."""
    known = np.count_nonzero(np.isfinite(group.mean))
    if known < 2 or overview.metric.better == "none":
        return []
    if not group.stands:
        best = both(method_names(overview, group.best))
        end = "Highest" if overview.metric.better == "higher" else "Lowest"
        return [(end, f"{best} {_value(overview, group, group.best[0])}")]
    mean = float(group.mean[group.best[0]])
    order = sorted(group.tied, key=lambda place: abs(group.difference[place]))
    tied = [
        f"{name} {signed(group.difference[place], overview.metric.unit, mean)}"
        for name, place in zip(method_names(overview, order), order, strict=True)
    ]
    rows = [("Tied", few(tied) if tied else "none")]
    if group.behind:
        rows.append(("Behind", _behind(overview, group)))
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
        f'<span class="overview-suspect">\N{WHITE DIAMOND} {len(group.suspect):,} of '
        f"{count_text(len(group.unit), overview.blocks)}</span>"
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
    rest = f'<p class="overview-scope">{more} more rows are in the table.</p>' if more > 0 else ""
    return (
        f'<figure class="table overview-grid"><table><thead><tr>{heads}</tr></thead>'
        f"<tbody>{body}</tbody></table></figure>{rest}"
    )


def scope_line(overview: Overview) -> str:
    """Return what the verdicts hold for, and what the numbers are."""
    scopes = list(dict.fromkeys(group.scope for group in overview.groups if group.scope))
    metric = overview.metric
    first = scopes[0] if scopes else ""
    if first.startswith("over "):
        units = strong(f"Scope: {first.removeprefix('over ')}")
        holds = f"{units}. Holds for further {escape(overview.units)}."
    elif first and not any(group.stands for group in overview.groups):
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
    return f'<p class="overview-scope">{holds}{few} {numbers}</p>'
