"""The first screen of a report: an answer and its cards as HTML."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from importlib.resources import files

from markupsafe import Markup, escape

from nodegraph_tables.answer import MOST_CARDS, ONE_ROW, Answer, Card, Row, Rows
from nodegraph_tables.line import WIDE, Line, tick_text
from nodegraph_tables.style import unit_text
from nodegraph_tables.text import Text, Word, html_of, joined, of_method

_NARROW = 105.0
"""Width of the line of a row where four cards stand side by side, in pixels."""

_SHORT_UNIT = 3

_LONGEST = 24
"""Letters of a name up to which the lines of all cards make room for it."""

_EDGE = 0.3
"""Share of a line at either end where numbers do not stand around their place."""


def answer_html(answer: Answer, caption: str = "") -> Markup:
    """Return an answer as HTML; `lead_style` is its style sheet.

    Parameters
    ----------
    answer
    caption
        What the author says of the numbers.
    """
    more = len(answer.cards) - MOST_CARDS
    rest = f'<p class="lead-key">{more} more are in the table.</p>' if more > 0 else ""
    return lead_of_parts(answer, cards_html(answer.cards[:MOST_CARDS]) + rest, caption)


def lead_of_parts(answer: Answer, cards: str, caption: str, methods: Text = ()) -> Markup:
    """Return the HTML of an answer whose cards are HTML already.

    Above them stands what it holds for, how certain it is, and what was measured; below, what
    terms mean and what methods do.
    """
    held = joined(" ", [part for part in answer.scope if isinstance(part, Word)])
    measured = joined(" ", [part.strip() for part in answer.scope if isinstance(part, str)])
    sentence = f'<p class="lead-sentence">{html_of(answer.sentence)}</p>'
    facts = _facts_html(
        "facts", {"For whom": held, "How certain": answer.certainty, "Measured": measured}
    )
    words = _facts_html("words", {"Terms": (caption,) * bool(caption), "Methods": methods})
    return Markup(f'<div class="lead">{sentence}{facts}{cards}{words}</div>')


def _facts_html(name: str, facts: Mapping[str, Text]) -> str:
    items = "".join(
        f"<dt>{term}</dt><dd>{html_of(text)}</dd>" for term, text in facts.items() if text
    )
    return f'<dl class="lead-{name}">{items}</dl>' if items else ""


def cards_html(cards: Sequence[Card]) -> str:
    """Return cards side by side; nothing where there are none."""
    columns = len(cards) if len(cards) <= ONE_ROW else math.ceil(len(cards) / 2)
    inside = "".join(map(_card, cards))
    # the lines of all cards are as long and begin at the same place
    shown = [(card.rows, row) for card in cards if card.rows for row in card.rows.rows]
    names = min(max((len(row.name) for _, row in shown), default=0), _LONGEST)
    numbers = max((len(rows.number(row)) for rows, row in shown), default=0)
    style = f"--columns: {columns}; --names: {names}; --numbers: {numbers}"
    return f'<div class="lead-cards" style="{style}">{inside}</div>' if cards else ""


@cache
def lead_style() -> str:
    """Return the style sheet of leads."""
    return files("nodegraph_tables").joinpath("lead.css").read_text(encoding="utf-8")


def _card(card: Card) -> str:
    value = f"<b>{html_of(card.value)}</b> " if card.value else ""
    value += f"<small>{html_of(card.aside)}</small>" if card.aside else ""
    value = f'<span class="lead-value">{value}</span>' if value else ""
    facts = "".join(f"<dt>{escape(term)}</dt><dd>{html_of(text)}</dd>" for term, text in card.facts)
    return (
        '<article class="lead-card">'
        + (f'<h3 aria-level="2">{html_of(card.title)}</h3>' if card.title else "")
        + (
            f'<p class="lead-winner {card.kind}">{_headline(card.headline)} {value}</p>'
            if card.headline or value
            else ""
        )
        + (f'<p class="lead-status {card.kind}">{html_of(card.status)}</p>' if card.status else "")
        + card.picture
        + (_rows_html(card.rows, judged=card.kind != "rest") if card.rows else "")
        + (f"<dl>{facts}</dl>" if facts else "")
        + "</article>"
    )


def _headline(text: Text) -> Markup:
    """Return a headline in which, beside names, other words are small."""
    tag = "<small>{}</small>" if any(isinstance(part, Word) for part in text) else "{}"
    return Markup("").join(
        Markup(tag).format(part) if isinstance(part, str) else html_of((part,)) for part in text
    )


def _rows_html(rows: Rows, *, judged: bool) -> str:
    body = "".join(
        f"<tr{of_method(row.name, row.does)}{_classes(row)}>"
        f'<th scope="row"{_titled(row.name)}>{escape(row.name)}</th>'
        f"<td>{_strip([row], rows)}</td><td>{escape(rows.number(row))}</td></tr>"
        + (f'<tr{_classes(row)}><td colspan="3">{html_of(row.note)}</td></tr>' if row.note else "")
        for row in rows.rows
    )
    if rows.others:
        body += (
            f'<tr><th scope="row">{len(rows.others)} others</th>'
            f"<td>{_strip(rows.others, rows)}</td><td></td></tr>"
        )
    # what the axis says is in the numbers
    axis = f'<tr aria-hidden="true"><td></td><td>{axis_html(rows)}</td><td></td></tr>'
    names = "lead-rows lead-judged" if judged else "lead-rows"
    return f'<table class="{names}"><tbody>{body}{axis}</tbody></table>'


def _titled(name: str) -> str:
    """Return the attribute that shows a name which its column cuts short, to hover."""
    return f' title="{escape(name)}"' if len(name) > _LONGEST else ""


def _classes(row: Row) -> str:
    names = [row.kind] * (row.kind == "best") + ["for-all"] * row.for_all
    return f' class="{" ".join(names)}"' if names else ""


def dots_html(rows: Rows) -> str:
    """Return the dots of all rows side by side."""
    return _strip(rows.every, rows)


def _strip(of: Sequence[Row], rows: Rows) -> str:
    """Return a dot with its interval, or several dots, and where 0 is, or the one multiple."""
    line = rows.line
    from_0 = not line.log and line.low <= 0.0
    parts = [_upright(line, line.one)] if from_0 or line.one else []
    for row in reversed(of):  # the first lies upon the others
        x, low, high = (_place(line, each) for each in (row.value, row.low, row.high))
        if len(of) == 1 and row.low < row.high:
            parts.append(f'<line class="reach" x1="{low}" x2="{high}" y1="8" y2="8"/>')
        radius = 4 if row.kind == "rest" or len(of) > 1 else 5
        name = escape(f"{row.name} {rows.number(row)}")
        attributes = of_method(row.name, row.does) if len(of) > 1 else ""
        parts.append(
            f'<circle class="{row.kind}" cx="{x}" cy="8" r="{radius}"{attributes}>'
            f"<title>{name}</title></circle>"
        )
    return f'<svg class="lead-strip" height="16" aria-hidden="true">{"".join(parts)}</svg>'


def axis_html(rows: Rows) -> str:
    """Return the axis of the dots of rows: its ends, or ticks where it is logarithmic."""
    line, texts = rows.line, []
    ends, one = [line.low, line.high], line.one or 1.0
    if line.one:
        multiples = Line(line.low / one, line.high / one, log=True).ticks(_NARROW)
        ends = [one * each for each in multiples]
    elif line.log:
        ends = line.ticks(_NARROW)
    elif line.low < 0.0 < line.high:
        # no number stands too near to that at 0
        ends = [0.0, *(end for end in ends if abs(line.share(end) - line.share(0.0)) > _EDGE)]
    for tick in ends:
        share = line.share(tick)
        anchor = "" if share < _EDGE else "end" if share > 1.0 - _EDGE else "middle"
        anchor = "middle" if line.log else anchor
        with_unit = tick == ends[-1] and len(unit_text(rows.unit)) <= _SHORT_UNIT
        text = tick_text(tick, rows.unit, with_unit=with_unit)
        if line.one:
            text = f"{tick_text(tick / one, '')}\N{MULTIPLICATION SIGN}"
        texts.append(
            f'<text class="{anchor}" x="{_place(line, tick)}" y="15">{escape(text)}</text>'
            f'<line x1="{_place(line, tick)}" x2="{_place(line, tick)}" y1="0" y2="4"/>'
        )
    whole = f'<line x1="{_place(line, line.low)}" x2="{_place(line, line.high)}" y1="0" y2="0"/>'
    return f'<svg class="lead-strip" height="18" aria-hidden="true">{whole}{"".join(texts)}</svg>'


def _upright(line: Line, value: float) -> str:
    x = _place(line, value)
    return f'<line class="grid" x1="{x}" x2="{x}" y1="-3" y2="19"/>'


def _place(line: Line, value: float) -> str:
    """Return where a value lies on a strip of any width."""
    return "0" if math.isnan(value) else f"{2.0 + 96.0 * line.share(value):.1f}%"


def svg(name: str, height: float, parts: Iterable[str], width: float = WIDE) -> str:
    """Return the picture of a card; classes of parts are those of `lead.css`.

    Parameters
    ----------
    name
        Description for a reader who does not see it.
    height, width
        In pixels.
    parts
        SVG elements.
    """
    wide = " wide" * (width > WIDE)
    return (
        f'<svg class="lead-picture{wide}" viewBox="0 0 {width:g} {height:g}" role="img" '
        f'aria-label="{escape(name)}">{"".join(parts)}</svg>'
    )


def dot(x: float, y: float, kind: str, name: str, radius: float = 4.0) -> str:
    """Return a dot with a name to hover.

    Parameters
    ----------
    x, y, radius
        In pixels.
    kind
        ``best``, ``tied``, ``before``, ``worse`` or ``rest``.
    name
    """
    return (
        f'<circle class="{kind}" cx="{x:g}" cy="{y:g}" r="{radius:g}">'
        f"<title>{escape(name)}</title></circle>"
    )
