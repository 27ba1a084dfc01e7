"""The answer of a comparison on a page: its sentence over cards, or a grid of winners."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Literal

import numpy as np
from markupsafe import Markup, escape

from nodegraph_compare.cards import NO_DIFFERENCE, card_of, kinds_of, lines_of, without_unit
from nodegraph_compare.words import (
    behind_text,
    beside_best,
    best_words,
    group_title,
    method_words,
    plain_names,
    varying,
)
from nodegraph_tables.answer import MOST_CARDS, ONE_ROW, Rows, with_descriptions
from nodegraph_tables.lead import axis_html, cards_html, dots_html, lead_of_parts
from nodegraph_tables.numbers import span_text
from nodegraph_tables.text import HERE, Word, html_of, joined, listing, say

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence, Set

    from nodegraph import Label
    from nodegraph_compare.verdict import Verdict, Verdicts
    from nodegraph_tables.answer import Answer, Card, Kind
    from nodegraph_tables.line import Line
    from nodegraph_tables.text import Text

    _Part = tuple[Kind | Literal[""], Text, Text]
    _Cell = tuple[_Part | Rows, ...]

_MOST_COLUMNS = 6
_MOST_ROWS = 60
_MOST_DOTS = 1000
"""In all cells of a grid together."""
_NONE = "\N{EN DASH}"
_DOT, _CARD = 0.026, 0.2
"""Width of a dot as a share of a page's only line, and by how much each card shortens it."""
_SOURCE = re.compile(r" \([^()]*\)\.$")


def answer_html(
    answer: Answer, verdicts: Verdicts, summaries: Mapping[Label, str], caption: str = ""
) -> Markup:
    """Return the answer, and the verdicts of all groups.

    Up to eight groups have a card each; more stand in a grid.

    Parameters
    ----------
    answer
    verdicts
        Of the comparison, with labels as a reader sees them.
    summaries
        What methods do, by their labels, in a sentence.
    caption
        What the author says of the numbers.
    """
    does = {str(label): _SOURCE.sub(".", text) for label, text in summaries.items() if text}
    told = with_descriptions(answer, does)
    lines = lines_of(verdicts)
    drawn, inside = {row.kind for card in told.cards if card.rows for row in card.rows.every}, ""
    if lines and len(verdicts.groups) > MOST_CARDS:
        cells = tuple(
            _cell(verdicts, group, line)
            for group, line in zip(verdicts.every, [*lines, lines[0]], strict=False)
        )
        drawn = {kind for cell in cells for kind in _kinds_in(cell)}
        inside = _grid(verdicts, with_descriptions(cells, does))
    elif lines:
        inside = cards_html(told.cards)
    return lead_of_parts(told, f"{key(verdicts, drawn, lines)}{inside}", caption, _described(told))


def _described(answer: Answer) -> Text:
    """Return what each method does that the answer names."""
    heads = (word for card in answer.cards for word in card.headline)
    words = (*answer.sentence, *answer.certainty, *heads)
    does = {word.label: word.does for word in words if isinstance(word, Word) and word.does}
    texts = [
        say(f"{HERE}: {text}", Word(label, "method", does=text)) for label, text in does.items()
    ]
    return joined(" ", texts)


def _grid(verdicts: Verdicts, texts: Sequence[_Cell]) -> str:
    """Return the best of every group in rows and columns, where there are many groups."""
    axes = varying(verdicts)
    last = axes[-1]
    tops = list(dict.fromkeys(group.labels[last] for group in verdicts.groups))
    if len(axes) < 2 or len(tops) > _MOST_COLUMNS:
        return _list(verdicts, texts)
    cells = {
        (tuple(group.labels[axis] for axis in axes[:-1]), group.labels[last]): text
        for group, text in zip(verdicts.groups, texts, strict=False)
    }
    sides = list(dict.fromkeys(side for side, _ in cells))
    names = [verdicts.within[axis] for axis in axes[:-1]]
    sides_heads = "".join(f'<th scope="col" rowspan="2">{escape(name)}</th>' for name in names)
    axis = _axis(texts)
    top_heads = "".join(f'<th scope="col">{escape(str(top))}{axis}</th>' for top in tops)
    heads = (
        f'{sides_heads}<th scope="colgroup" colspan="{len(tops)}">{escape(verdicts.within[last])}'
        f"</th></tr><tr>{top_heads}"
    )
    # on a phone each cell says itself what it is about
    rows = [
        "".join(
            f'<th scope="row" data-head="{escape(name)}">{escape(str(label))}</th>'
            for name, label in zip(names, side, strict=True)
        )
        + "".join(
            f'<td data-head="{escape(f"{verdicts.within[last]} {top}")}"'
            f"{_filled(verdicts, cells.get((side, top), ()))}"
            for top in tops
        )
        for side in sides
    ]
    if verdicts.overall is not None:
        rows.append(
            f'<th scope="row" data-head="all" colspan="{len(names)}">'
            f"{len(verdicts.groups)} groups together</th>"
            f'<td data-head="best" colspan="{len(tops)}"'
            f"{_filled(verdicts, texts[-1])}"
        )
    return _table(heads, rows)


def _list(verdicts: Verdicts, texts: Sequence[_Cell]) -> str:
    name = ", ".join(verdicts.within[axis] for axis in varying(verdicts))
    heads = f'<th scope="col">{escape(name)}</th><th scope="col">best{_axis(texts)}</th>'
    rows = [
        f'<th scope="row">{escape(group_title(verdicts, group))}</th><td{_filled(verdicts, text)}'
        for group, text in zip(verdicts.groups, texts, strict=False)
    ]
    return _table(heads, rows)


def _axis(cells: Sequence[_Cell]) -> str:
    """Return the axis of the dots of cells, which they share; empty where they have none."""
    return next((axis_html(part) for cell in cells for part in cell if isinstance(part, Rows)), "")


def _filled(verdicts: Verdicts, cell: _Cell) -> str:
    """Return the rest of a cell; the method to take is tinted."""
    take = "" if verdicts.for_all is None else str(verdicts.methods[verdicts.for_all])
    names = dict(_dots(verdicts))
    parts = []
    for part in cell:
        if isinstance(part, Rows):
            parts.append(dots_html(part))
            continue
        kind, name, number = part
        dot = _dot(kind, names[kind]) if kind else ""
        value = Markup(" <small>{}</small>").format(html_of(number)) if number else ""
        is_taken = take and any(isinstance(word, Word) and word.label == take for word in name)
        tint = ' class="for-all"' * bool(is_taken)
        parts.append(f"<div{tint}>{dot} {html_of(name)}{value}</div>")
    return f">{''.join(parts) or _NONE}</td>"


def _cell(verdicts: Verdicts, group: Verdict, line: Line) -> _Cell:
    """Return the card of a group in short: its best, the dots of all, who is told beside it."""
    if not group.known:
        return ()
    bare = without_unit(verdicts)
    card, kinds = card_of(bare, group, line), kinds_of(bare, group)
    are_few = len(verdicts.groups) * len(verdicts.methods) <= _MOST_DOTS
    dots = (card.rows,) if card.rows and are_few and group is not verdicts.overall else ()
    first, beside = _first(bare, group, card), beside_best(bare, group)
    if len(beside) > 1:
        return (first, *dots, ("tied", (f"{len(beside)} others",), ()))
    others: list[_Part] = [
        (kinds.get(place, "rest"), (name,), behind_text(bare, group, place))
        for place, name in zip(beside, method_words(bare, beside), strict=True)
    ]
    return (first, *dots, *others)


def _first(verdicts: Verdicts, group: Verdict, card: Card) -> _Part:
    """Return the best of a group, with its mean; or what a card says in its place."""
    unit = verdicts.metric.unit
    if verdicts.metric.better == "none":
        return ("", (span_text([np.nanmin(group.mean), np.nanmax(group.mean)], unit),), ())
    if verdicts.is_sequence or len(group.known) == 1:
        return ("", card.headline, card.value)
    mean = span_text([group.mean[group.best[0]]], unit)
    if not group.told:
        why = "" if group.stands else "; no verdict"
        return ("open", listing(method_words(verdicts, group.best)), (f"{mean}{why}",))
    take = "take " * (group is verdicts.overall and verdicts.for_all in group.best)
    names = (best_words if group.marked("best") else method_words)(verdicts, group.best)
    return (card.kind if group.marks else "", (take, *listing(names)), (mean,))


def _kinds_in(cell: _Cell) -> Iterator[Kind]:
    """Yield the kinds of the dots of a cell."""
    for part in cell:
        if isinstance(part, Rows):
            yield from (row.kind for row in part.every)
        elif part[0]:
            yield part[0]


def _table(heads: str, rows: Sequence[str]) -> str:
    body = "".join(f"<tr>{row}</tr>" for row in rows[:_MOST_ROWS])
    more = len(rows) - _MOST_ROWS
    rest = f'<p class="lead-key">{more} more rows are in the table.</p>' if more > 0 else ""
    return (
        f'<figure class="table lead-grid"><table><thead><tr>{heads}</tr></thead>'
        f"<tbody>{body}</tbody></table></figure>{rest}"
    )


def key(verdicts: Verdicts, drawn: Set[Kind], lines: Sequence[Line]) -> str:
    """Return what dots, lines and tints are.

    Parameters
    ----------
    verdicts
    drawn
        The kinds of dots that there are.
    lines
        On which they lie, a line for each group.
    """
    parts = [f"{_dot(kind)} {escape(text)}" for kind, text in _dots(verdicts) if kind in drawn]
    if parts:
        parts += map(escape, _about_dots(verdicts, lines))
    if verdicts.for_all is not None:
        (take,) = plain_names(verdicts, [verdicts.for_all])
        parts.append(f"<mark>tinted</mark>: {escape(take)}, the one to take")
    are_cards = len(verdicts.groups) <= MOST_CARDS
    if are_cards and any(group.suspects_matter for group in verdicts.groups):
        parts.append(escape(f"\N{WHITE DIAMOND}: {verdicts.blocks} whose truth may be damaged"))
    spans = "".join(f"<span>{part}</span>" for part in parts)
    return f'<p class="lead-key">{spans}</p>' if parts else ""


def _dot(kind: Kind, name: str = "") -> Markup:
    """Return a dot as cards have it, with a name where no words beside it say what it is."""
    said = Markup('role="img" aria-label="{0}"').format(name) if name else 'aria-hidden="true"'
    title = Markup("<title>{}</title>").format(name) if name else ""
    circle = Markup(f'<circle class="{kind}" cx="6" cy="6" r="5"/>')
    return Markup(f'<svg width="12" height="12" {said}>{circle}{title}</svg>')


def _about_dots(verdicts: Verdicts, lines: Sequence[Line]) -> Iterator[str]:
    """Yield what stands beside dots, and what the lines are on which they lie."""
    line = lines[0]
    if len(verdicts.groups) <= MOST_CARDS and (known := _widths(verdicts, lines)):
        columns = len(lines) if len(lines) <= ONE_ROW else math.ceil(len(lines) / 2)
        short = max(known) < _DOT / (1.0 - _CARD * columns)
        yield "the dot covers the 95 % interval" if short else "line: 95 % interval"
    if verdicts.is_sequence:
        yield "%: change to the one before"
    if line.one:
        yield "axis: multiples of the lowest, logarithmic"
    elif line.log:
        yield f"axis: logarithmic{', but 0 at its left end' * bool(line.least)}"


def _widths(verdicts: Verdicts, lines: Sequence[Line]) -> list[float]:
    """Return the widths of all intervals, as shares of their line."""
    return [
        line.share(high) - line.share(low)
        for group, line in zip(verdicts.groups, lines, strict=True)
        for low, high in zip(group.low, group.high, strict=True)
        if np.isfinite(low)
    ]


def _dots(verdicts: Verdicts) -> Iterator[tuple[Kind, str]]:
    """Yield the kinds of dots that cards may have, with what they are."""
    groups = verdicts.groups
    if verdicts.is_sequence:
        if any(group.stands for group in groups):
            yield "before", "where it begins"
            yield "best", "clearly better than before"
            yield "worse", "clearly worse"
            yield "rest", "hardly changed"
        return
    yield "best", "clearly best"
    yield "tied", "may be the best"
    if any(group.behind for group in verdicts.every):
        yield "rest", "clearly behind"
    stands = {group.stands for group in verdicts.every if not group.told}
    said = [NO_DIFFERENCE] * (True in stands) + ["no verdict"] * (False in stands)
    yield "open", " or ".join(said)
    if verdicts.baseline is not None:
        yield "before", f"{verdicts.baseline} (reference)"
