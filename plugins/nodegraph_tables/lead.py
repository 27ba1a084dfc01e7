"""An answer at a glance: a sentence, a card for each part of it, and what it holds for."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from importlib.resources import files

from nodegraph import Value

MOST_CARDS = 8
"""Cards that a reader sees at once."""

_ONE_ROW = 4

_WIDE = 240.0
"""Of the picture on a card, in pixels."""

_SMALLEST, _LARGEST = 1e-3, 1e6

Text = tuple[str, ...]
"""A text whose second, fourth, ... part stands out."""


@dataclass(frozen=True)
class Card(Value):
    """A part of an answer.

    Attributes
    ----------
    title : str
        What it is about, such as an actor or a step.
    headline : str
        The answer in a word or a number.
    value, aside : str
        What stands below it, large and small.
    picture : str
        An SVG element: see `svg`. The only field that is not escaped.
    facts : tuple of (term, text)
    best : bool
        Whether the headline is in the colour of the best.
    """

    title: str
    headline: str
    value: str = ""
    aside: str = ""
    picture: str = ""
    facts: tuple[tuple[str, str], ...] = ()
    best: bool = False


@dataclass(frozen=True)
class Lead(Value):
    """What a table answers, on the first screen of a report.

    Attributes
    ----------
    sentence : tuple of str
        The second, fourth, ... part of it stands out.
    cards : tuple of Card
        Eight at most are shown.
    scope : str
        What the answer holds for, and what the numbers are.
    """

    sentence: Text
    cards: tuple[Card, ...] = ()
    scope: str = ""


def lead_html(lead: Lead) -> str:
    """Return a lead as HTML; `lead_style` is its style sheet."""
    sentence = "".join(
        f"<strong>{escape(part)}</strong>" if place % 2 else escape(part)
        for place, part in enumerate(lead.sentence)
    )
    cards = "".join(map(_card, lead.cards[:MOST_CARDS]))
    count = min(len(lead.cards), MOST_CARDS)
    columns = count if count <= _ONE_ROW else math.ceil(count / 2)
    more = len(lead.cards) - MOST_CARDS
    scope = f"{lead.scope} {more} more are in the table." if more > 0 else lead.scope
    return (
        f'<div class="lead"><p class="lead-sentence">{sentence}</p>'
        + (f'<div class="lead-cards" style="--columns: {columns}">{cards}</div>' if cards else "")
        + (f'<p class="lead-scope">{escape(scope)}</p>' if scope else "")
        + "</div>"
    )


@cache
def lead_style() -> str:
    """Return the style sheet of leads."""
    return files("nodegraph_tables").joinpath("lead.css").read_text(encoding="utf-8")


def _card(card: Card) -> str:
    kind = "lead-winner" if card.best else "lead-winner lead-plain"
    aside = f" <small>{escape(card.aside)}</small>" if card.aside else ""
    facts = "".join(f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>" for term, text in card.facts)
    return (
        f'<article class="lead-card"><h3 aria-level="2">{escape(card.title)}</h3>'
        f'<p class="{kind}">{escape(card.headline)}</p>'
        + (f'<p class="lead-value"><b>{escape(card.value)}</b>{aside}</p>' if card.value else "")
        + card.picture
        + (f"<dl>{facts}</dl>" if facts else "")
        + "</article>"
    )


def number_text(value: float, unit: str = "") -> str:
    """Return a number as a card writes it: three digits below 10, fewer decimals above.

    Examples
    --------
    >>> number_text(0.49712, "mm"), number_text(213.0), number_text(2.1e-5)
    ('0.497 mm', '213', '2.1e-05')
    """
    if not math.isfinite(value):
        return "no number"
    size = abs(value)
    if size and not _SMALLEST <= size < _LARGEST:
        text = f"{value:.2g}"
    else:
        decimals = 2 - math.floor(math.log10(size)) if size else 0
        text = f"{value:.{min(max(decimals, 0), 4)}f}"
    return f"{text} {unit}".rstrip()


def svg(name: str, height: float, parts: Iterable[str]) -> str:
    """Return the picture of a card, 240 pixels wide; classes of parts are those of `lead.css`.

    Parameters
    ----------
    name
        What a reader who does not see it is told.
    height
        In pixels.
    parts
        SVG elements.
    """
    return (
        f'<svg class="lead-picture" viewBox="0 0 {_WIDE:g} {height:g}" role="img" '
        f'aria-label="{escape(name)}">{"".join(parts)}</svg>'
    )


@dataclass(frozen=True)
class Line:
    """A line of numbers across a card.

    Attributes
    ----------
    low, high : float
        Its ends.
    log : bool
        Whether equal distances are equal ratios.
    """

    low: float
    high: float
    log: bool = False

    def at(self, value: float) -> float:
        """Return where a value lies, in pixels from the left."""
        low, high, place = (
            math.log(each) if self.log else each for each in (self.low, self.high, value)
        )
        share = (place - low) / (high - low) if high > low else 0.5
        return round(10.0 + (_WIDE - 20.0) * min(max(share, 0.0), 1.0), 1)

    def drawn(self, y: float, unit: str = "") -> str:
        """Return the line with its ends named below it."""
        low, high = number_text(self.low), number_text(self.high, unit)
        return (
            f'<line x1="4" x2="{_WIDE - 4:g}" y1="{y:g}" y2="{y:g}"/>'
            f'<text x="4" y="{y + 14:g}">{escape(low)}</text>'
            f'<text class="end" x="{_WIDE - 4:g}" y="{y + 14:g}">{escape(high)}</text>'
        )


def line_of(values: Sequence[float]) -> Line:
    """Return the line on which all values lie: logarithmic where they span a decade."""
    known = [value for value in values if math.isfinite(value)] or [0.0]
    low, high = min(known), max(known)
    return Line(low, high, log=low > 0.0 and high > 10.0 * low)


def dot(x: float, y: float, kind: str, name: str, radius: float = 4.0) -> str:
    """Return a dot, ``best``, ``tied``, ``before``, ``worse`` or ``rest``, with a name to hover."""
    return (
        f'<circle class="{kind}" cx="{x:g}" cy="{y:g}" r="{radius:g}">'
        f"<title>{escape(name)}</title></circle>"
    )
