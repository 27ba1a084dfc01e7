"""The means of all methods of a group as dots on a line, as SVG that needs no script."""

from __future__ import annotations

import math
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.overview.words import in_unit, number
from nodegraph_tables.style import unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nodegraph_compare.overview.value import GroupOverview, Overview

_WIDTH, _MARGIN = 360, 16
_LINE, _HEIGHT = 26, 46
_TICKS = 5
_LETTER = 7.0


@dataclass(frozen=True)
class Axis:
    """The scale that all strips of an overview share.

    Attributes
    ----------
    low, high : float
        The smallest and the largest mean.
    log : bool
        Whether equal distances are equal ratios: where all means are above 0.
    """

    low: float
    high: float
    log: bool

    def place(self, value: float) -> float:
        """Return where a value lies between the ends of the line, in pixels."""
        low, high, at = (math.log(x) if self.log else x for x in (self.low, self.high, value))
        share = (at - low) / (high - low) if high > low else 0.5
        return _MARGIN + (_WIDTH - 2 * _MARGIN) * share

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
            room = _LETTER * len(number(value)) + 6
            if not kept or self.place(value) - self.place(kept[-1]) >= room:
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


def axis_of(overview: Overview) -> Axis | None:
    """Return the axis for all groups; None where no mean is known."""
    means = np.concatenate([group.mean for group in overview.groups] or [np.empty(0)])
    means = means[np.isfinite(means)]
    if not len(means):
        return None
    low, high = float(means.min()), float(means.max())
    # shares of 0 have no logarithm; with them the line is an ordinary one
    return Axis(low, high, log=low > 0 and overview.metric.better != "none")


def strip(overview: Overview, group: GroupOverview, axis: Axis) -> str:
    """Return the dots of one group: the best filled, ringed what is not clearly apart from it."""
    unit = overview.metric.unit
    known = np.flatnonzero(np.isfinite(group.mean)).tolist()
    best, tied = (group.best, group.tied) if group.stands else ((), ())
    kinds = dict.fromkeys(known, "rest") | dict.fromkeys(tied, "tied") | dict.fromkeys(best, "best")
    # the best is drawn last, above what it covers
    order = sorted(known, key=lambda place: ("rest", "tied", "best").index(kinds[place]))
    dots = [_dot(overview, group, place, kinds[place], axis) for place in order]
    ticks = axis.ticks()
    marks = [
        f'<line x1="{(x := axis.place(tick)):.1f}" x2="{x:.1f}" y1="{_LINE}" y2="{_LINE + 4}"/>'
        f'<text x="{x:.1f}" y="{_HEIGHT - 4}">{_tick(tick, unit, last=tick == ticks[-1])}</text>'
        for tick in ticks
    ]
    names = ", ".join(
        f"{overview.methods[place]} {number(group.mean[place])}"
        for place in sorted(known, key=lambda place: group.mean[place])[:20]
    )
    return (
        f'<svg class="strip" viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" '
        f'aria-label="{escape(f"mean {overview.metric.name} of {len(known)} methods: {names}")}">'
        f'<line x1="{_MARGIN - 6}" x2="{_WIDTH - _MARGIN + 6}" y1="{_LINE}" y2="{_LINE}"/>'
        f"{''.join(marks)}{''.join(dots)}</svg>"
    )


def _dot(overview: Overview, group: GroupOverview, place: int, kind: str, axis: Axis) -> str:
    name, mean = escape(str(overview.methods[place])), float(group.mean[place])
    radius = 4 if kind == "rest" else 5
    return (
        f'<circle class="{kind}" cx="{axis.place(mean):.1f}" cy="12" r="{radius}" '
        f'data-method="{name}"><title>{name} {in_unit([mean], overview.metric.unit)}</title>'
        "</circle>"
    )


def _tick(value: float, unit: str, *, last: bool) -> str:
    text = f"{100 * value:g}" if unit == "share" else f"{value:.3g}"
    shown = "%" if unit == "share" else unit_text(unit)
    return escape(f"{text} {shown}".rstrip() if last else text)
