"""The line of numbers across a card: its ends, its ticks, and where a number lies on it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from markupsafe import escape

from nodegraph import Value
from nodegraph_tables.numbers import LARGEST, MINUS, SMALLEST, number_text
from nodegraph_tables.style import scale_of, unit_text

WIDE = 240.0
"""Width of the picture on a card, in pixels."""

_TICKS = 5

_PARTS = 10
"""Of a line whose ends are round."""

_DECADE = 10.0

_LETTER = 6.0
"""Across, in pixels."""

_PLAIN = 1e3
"""Number from which on three digits would be a power of ten."""


@dataclass(frozen=True)
class Line(Value):
    """A line of numbers across a card.

    Attributes
    ----------
    low, high : float
        Its ends.
    log : bool
        Whether equal distances are equal ratios.
    least : float
        With a line from 0: the number down to which they are; 0 on other lines.
    one : float
        The number of which its ticks are multiples; 0 where they are numbers.
    """

    low: float
    high: float
    log: bool = False
    least: float = 0.0
    one: float = 0.0

    @property
    def to_rounds(self) -> Line:
        """The line on to the next round numbers at both ends."""
        if not self.high > self.low:
            return self
        if not self.log:
            step = self._step(_PARTS)
            first, last = math.floor(self.low / step), math.ceil(self.high / step)
            return replace(self, low=step * first, high=step * last)
        low = self.low and max(each for each in _rounds(self.low) if each <= self.low)
        return replace(self, low=low, high=min(e for e in _rounds(self.high) if e >= self.high))

    @classmethod
    def through(cls, values: Sequence[float], *, log: bool) -> Line:
        """Return the line on which all values lie; logarithmic, if wanted, where none is below 0.

        Values of 0 among others of many sizes lie at its left end.
        """
        low, high = min(values), max(values)
        above = min((value for value in values if value > 0.0), default=high)
        from_0 = log and low == 0.0 and high > _DECADE * above
        return cls(low, high, log and (low > 0.0 or from_0), above if from_0 else 0.0)

    def at(self, value: float) -> float:
        """Return where a value lies, in pixels from the left."""
        return round(10.0 + (WIDE - 20.0) * self.share(value), 1)

    def share(self, value: float) -> float:
        """Return where a value lies, as a share of the line; at an end, where it is beyond."""
        near = min(max(value, self.low), self.high)
        low, high, place = (self._along(each) for each in (self.low, self.high, near))
        return (place - low) / (high - low) if high > low else 0.5

    def _along(self, value: float) -> float:
        if self.least:
            return math.asinh(value / self.least)
        return math.log(value) if self.log else value

    def drawn(self, y: float, unit: str = "") -> str:
        """Return the line with its ticks, whose numbers stand below it."""
        ticks = self.ticks()
        marks: list[str] = []
        free = WIDE
        # the last has the unit, and others a number as far as there is room before it
        for tick in reversed(ticks):
            x = self.at(tick)
            text = tick_text(tick, unit, with_unit=tick == ticks[-1])
            width = _LETTER * len(text)
            anchor = "start" if x < width / 2 else "end" if x > WIDE - width / 2 else "middle"
            left = x - width * {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor]
            mark = f'<line x1="{x:g}" x2="{x:g}" y1="{y:g}" y2="{y + 4:g}"/>'
            if left + width <= free:
                mark += f'<text class="{anchor}" x="{x:g}" y="{y + 16:g}">{escape(text)}</text>'
                free = left - _LETTER
            marks.append(mark)
        return f'<line x1="4" x2="{WIDE - 4:g}" y1="{y:g}" y2="{y:g}"/>{"".join(reversed(marks))}'

    def ticks(self, width: float = WIDE - 20.0) -> list[float]:
        """Return at most a handful of round values on a line so wide, far enough apart."""
        if not self.high > self.low:
            return [self.low]
        for steps in ((1, 2, 5), (1, 3), (1,)):
            values = self._rounds(steps) if self.log else self._steps()
            if len(values) <= _TICKS:
                break
        values = values[:: math.ceil(len(values) / _TICKS) or 1]
        if len(values) < 2:
            values = [self.low, self.high]
        place = 1
        while place < len(values):
            before, value = values[place - 1 : place + 1]
            letters = len(tick_text(before, "")) + len(tick_text(value, ""))
            if width * (self.share(value) - self.share(before)) >= _LETTER * letters / 2 + 6:
                place += 1
                continue
            values.pop(max(place - 1, 1))  # the first stays, and the last beside others
            place = max(place - 1, 1)
        return values

    def _rounds(self, steps: Sequence[int]) -> list[float]:
        low = self.least or self.low
        decades = range(math.floor(math.log10(low)), math.ceil(math.log10(self.high)) + 1)
        values = (step * 10.0**decade for decade in decades for step in steps)
        rounds = [value for value in values if low <= value <= self.high]
        return [0.0, *rounds] if self.least else rounds

    def _steps(self) -> list[float]:
        step = self._step(_TICKS - 1)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * place for place in range(first, last + 1)]

    def _step(self, most: int) -> float:
        """Return the smallest round number of which the line is so many long at most."""
        rough = (self.high - self.low) / most
        decade = 10.0 ** math.floor(math.log10(rough))
        return next(decade * each for each in (1, 2, 5, 10) if decade * each >= rough)


def _rounds(value: float) -> list[float]:
    """Return the round numbers around one above 0."""
    decade = 10.0 ** math.floor(math.log10(value))
    return [decade * step for step in (0.5, 1, 2, 5, 10)]


def line_of(values: Sequence[float], ends: Iterable[float] = (), *, log: bool = True) -> Line:
    """Return the line on which all values lie, without any that makes them look far apart.

    It is logarithmic, if wanted, where values span a decade, and has 0 on it elsewhere. Its ends
    are round.

    Parameters
    ----------
    values
    ends
        Of intervals, which lie on it as well.
    log
    """
    known = [value for value in values if math.isfinite(value)] or [0.0]
    is_log = log and min(known) >= 0.0 and max(known) > _DECADE * min(known)
    if is_log:
        # above 0 such a line has a least number, which is no end of an interval
        least = 0.0 if min(known) > 0.0 else min(value for value in known if value > 0.0)
        values = [*known, *(end for end in ends if end > least)]
        return Line.through(values, log=True).to_rounds
    return Line.through([*known, *ends, 0.0], log=False).to_rounds


def tick_text(value: float, unit: str, *, with_unit: bool = False) -> str:
    """Return the number at a tick in few digits, with its unit if wanted."""
    shown = scale_of(unit) * value
    is_plain = not shown or SMALLEST <= abs(shown) < LARGEST
    digits = ",.0f" if abs(shown) >= _PLAIN else ".3g"
    text = f"{shown:{digits}}".replace("-", MINUS) if is_plain else number_text(shown)
    return f"{text} {unit_text(unit)}".rstrip() if with_unit else text
