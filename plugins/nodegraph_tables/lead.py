"""An answer at a glance: a sentence, a card for each part of it, and what it holds for."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from markupsafe import Markup, escape

from nodegraph import Value
from nodegraph_tables.numbers import LARGEST, MINUS, SMALLEST, number_text
from nodegraph_tables.style import scale_of, unit_text

MOST_CARDS = 8
"""Cards that a reader sees at once."""

_ONE_ROW = 4

_WIDE = 240.0
"""Width of the picture on a card, in pixels."""

_TICKS = 5
_LETTER = 6.0
"""Across, in pixels."""

Text = tuple[str, ...]
"""A text whose second, fourth, ... part stands out."""


@dataclass(frozen=True)
class Card(Value):
    """A part of an answer. Texts are escaped, unless they are `markupsafe.Markup`.

    Attributes
    ----------
    title : str
        What it is about, such as an actor or a step.
    headline : str
        The answer in a word or a number.
    value, aside : str
        What stands below it, large and small.
    picture : str
        An SVG element: see `svg`. It is taken as it is.
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
    """The answer of a table on the first screen of a report.

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
    sentence = Markup("").join(
        Markup("<strong>{}</strong>").format(part) if place % 2 else part
        for place, part in enumerate(lead.sentence)
    )
    more = len(lead.cards) - MOST_CARDS
    scope = f"{lead.scope} {more} more are in the table." if more > 0 else lead.scope
    return lead_of_parts(sentence_html(sentence), cards_html(lead.cards[:MOST_CARDS]), scope=scope)


def lead_of_parts(*parts: str, scope: str = "") -> str:
    """Return a lead of fragments of HTML, of which `scope`, where there is one, is the last."""
    last = f'<p class="lead-scope">{escape(scope)}</p>' if scope else ""
    return f'<div class="lead">{"".join(parts)}{last}</div>'


def sentence_html(sentence: str) -> str:
    """Return the sentence of a lead."""
    return f'<p class="lead-sentence">{escape(sentence)}</p>'


def cards_html(cards: Sequence[Card]) -> str:
    """Return cards side by side; nothing where there are none."""
    columns = len(cards) if len(cards) <= _ONE_ROW else math.ceil(len(cards) / 2)
    inside = "".join(map(_card, cards))
    return f'<div class="lead-cards" style="--columns: {columns}">{inside}</div>' if cards else ""


@cache
def lead_style() -> str:
    """Return the style sheet of leads."""
    return files("nodegraph_tables").joinpath("lead.css").read_text(encoding="utf-8")


def _card(card: Card) -> str:
    kind = "lead-winner" if card.best else "lead-winner lead-plain"
    value = f"<b>{escape(card.value)}</b> " if card.value else ""
    value += f"<small>{escape(card.aside)}</small>" if card.aside else ""
    facts = "".join(f"<dt>{escape(term)}</dt><dd>{escape(text)}</dd>" for term, text in card.facts)
    return (
        '<article class="lead-card">'
        + (f'<h3 aria-level="2">{escape(card.title)}</h3>' if card.title else "")
        + f'<p class="{kind}">{escape(card.headline)}</p>'
        + (f'<p class="lead-value">{value}</p>' if value else "")
        + card.picture
        + (f"<dl>{facts}</dl>" if facts else "")
        + "</article>"
    )


def svg(name: str, height: float, parts: Iterable[str]) -> str:
    """Return the picture of a card, 240 pixels wide; classes of parts are those of `lead.css`.

    Parameters
    ----------
    name
        Description for a reader who does not see it.
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
        """Return the line with its ticks, whose numbers stand below it."""
        ticks = self.ticks()
        marks = []
        for tick in ticks:
            x = self.at(tick)
            text = _tick_text(tick, unit, with_unit=tick == ticks[-1])
            half = _LETTER * len(text) / 2
            anchor = "start" if x < half else "end" if x > _WIDE - half else "middle"
            marks.append(
                f'<line x1="{x:g}" x2="{x:g}" y1="{y:g}" y2="{y + 4:g}"/>'
                f'<text class="{anchor}" x="{x:g}" y="{y + 16:g}">{escape(text)}</text>'
            )
        return f'<line x1="4" x2="{_WIDE - 4:g}" y1="{y:g}" y2="{y:g}"/>{"".join(marks)}'

    def ticks(self) -> list[float]:
        """Return at most a handful of round values on the line, far enough from each other."""
        if not self.high > self.low:
            return [self.low]
        for steps in ((1, 2, 5), (1, 3), (1,)):
            values = self._rounds(steps) if self.log else self._steps()
            if len(values) <= _TICKS:
                break
        values = values[:: math.ceil(len(values) / _TICKS) or 1]
        if len(values) < 2:
            values = [self.low, self.high]
        kept: list[float] = []
        for value in values:
            room = _LETTER * len(_tick_text(value, "")) + 6
            if not kept or self.at(value) - self.at(kept[-1]) >= room:
                kept.append(value)
        return kept

    def _rounds(self, steps: Sequence[int]) -> list[float]:
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        values = (step * 10.0**decade for decade in decades for step in steps)
        return [value for value in values if self.low <= value <= self.high]

    def _steps(self) -> list[float]:
        rough = (self.high - self.low) / (_TICKS - 1)
        decade = 10.0 ** math.floor(math.log10(rough))
        step = next(decade * each for each in (1, 2, 5, 10) if decade * each >= rough)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * place for place in range(first, last + 1)]


def _tick_text(value: float, unit: str, *, with_unit: bool = False) -> str:
    shown = scale_of(unit) * value
    is_plain = not shown or SMALLEST <= abs(shown) < LARGEST
    text = f"{shown:.3g}".replace("-", MINUS) if is_plain else number_text(shown)
    return f"{text} {unit_text(unit)}".rstrip() if with_unit else text


def line_of(values: Sequence[float]) -> Line:
    """Return the line on which all values lie: logarithmic where they span a decade."""
    known = [value for value in values if math.isfinite(value)] or [0.0]
    low, high = min(known), max(known)
    return Line(low, high, log=low > 0.0 and high > 10.0 * low)


def dot(x: float, y: float, kind: str, name: str, radius: float = 4.0, method: str = "") -> str:
    """Return a dot with a name to hover.

    Parameters
    ----------
    x, y, radius
        In pixels.
    kind
        ``best``, ``tied``, ``before``, ``worse`` or ``rest``.
    name
    method
        Whose dot it is: a report marks it where this one is selected.
    """
    of = f' data-method="{escape(method)}"' if method else ""
    return (
        f'<circle class="{kind}" cx="{x:g}" cy="{y:g}" r="{radius:g}"{of}>'
        f"<title>{escape(name)}</title></circle>"
    )
