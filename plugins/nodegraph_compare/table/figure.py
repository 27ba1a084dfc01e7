"""The picture of a comparison: means over blocks with their intervals."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_compare.pictures import Span, set_span, span_of, without_drawing
from nodegraph_compare.words import group_title, number_name, units_text
from nodegraph_mocap import figure_text
from nodegraph_tables.axes import SMALL, plain
from nodegraph_tables.style import BEST, BLACK, QUIET, REST, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from nodegraph_compare.verdict import Verdict, Verdicts

_MOST_PANELS = 24
_MOST_ACROSS = 4
_ROW = 0.19
_TALLEST = 7.6
"""Inches: a row of a method, and all rows of a panel at most."""

_MOST_NUMBERS = 40
"""Methods up to which the mean of each is written next to its interval."""

_GAP_ACROSS, _GAP_DOWN, _BELOW = 0.28, 0.42, 0.55
_LETTERS = 34
"""Letters in a line above a panel."""


def draw(verdicts: Verdicts) -> Figure:
    """Return the figure: a panel per group, in each a row per method.

    The last of `within` lies across. The methods have one order in all panels: by their mean
    place, where one end of the metric is better. At most 24 panels.
    """
    groups, unit = verdicts.groups, verdicts.metric.unit
    if not groups:
        return without_drawing("nothing to compare")
    drawn = [_printed(group, scale_of(unit)) for group in groups[:_MOST_PANELS]]
    methods = _ordered(verdicts)
    across = _across(drawn)
    down = math.ceil(len(drawn) / across)
    tall = min(max(_ROW * len(methods), 0.5), _TALLEST)
    wide = {1: 4.2, 2: 3.2, 3: 2.5}.get(across, 2.0)
    figure = Figure(
        figsize=(
            across * (wide + _GAP_ACROSS),
            down * (tall + _GAP_DOWN) + _BELOW,
        )
    )
    width, height = figure.get_size_inches()
    span = _span(drawn)
    names = _marked(verdicts)
    every = range(len(verdicts.within))
    for place, group in enumerate(drawn):
        column, row = place % across, place // across
        bottom = height - (row + 1) * (tall + _GAP_DOWN)
        axis = figure.add_axes(
            (column * (wide + _GAP_ACROSS) / width, bottom / height, wide / width, tall / height)
        )
        _panel(axis, group, methods, span)
        title = figure_text(group_title(verdicts, group, every), across=_LETTERS, lines=2)
        axis.set_title(title, fontsize=SMALL + 1, loc="left", pad=4)
        beside = drawn[place - column : place - column + across]
        _names(axis, beside if column == 0 else [], methods, names, tall)
        if place + across < len(drawn):
            axis.tick_params(axis="x", labelbottom=False)
    notes = [_quantity(verdicts, span), *_legend(drawn, names)]
    if len(drawn) < len(groups):
        notes.append(f"{len(groups) - len(drawn)} more panels are not drawn")
    figure.text(
        0, (_BELOW - 0.34) / height, "\n".join(notes), fontsize=SMALL, color=QUIET, va="top"
    )
    return figure


def _printed(group: Verdict, scale: float) -> Verdict:
    """Return a verdict whose numbers are those that are printed."""
    mean, low, high = (scale * each for each in (group.mean, group.low, group.high))
    return replace(group, mean=mean, low=low, high=high)


def _across(groups: Sequence[Verdict]) -> int:
    """Return how many panels are side by side: those of the last axis, if they fit."""
    last = dict.fromkeys(group.labels[-1:] for group in groups)
    rows = math.ceil(len(last) / _MOST_ACROSS)
    return math.ceil(len(last) / rows)


def _ordered(verdicts: Verdicts) -> list[int]:
    """Return the methods by their mean place over all groups, those without a number last."""
    if verdicts.metric.better == "none":
        return [*range(len(verdicts.methods))]
    places: dict[int, list[float]] = defaultdict(list)
    for group in verdicts.groups:
        ranked = [method for method in group.ranked if np.isfinite(group.mean[method])]
        for place, method in enumerate(ranked):
            places[method].append(place)
    every = range(len(verdicts.methods))
    return sorted(every, key=lambda method: np.mean(places[method] or [math.inf]))


def _span(groups: Sequence[Verdict]) -> Span:
    return span_of(
        np.concatenate([group.mean for group in groups]),
        np.concatenate([group.low for group in groups]),
        np.concatenate([group.high for group in groups]),
    )


def _panel(axis: Axes, group: Verdict, methods: Sequence[int], span: Span) -> None:
    set_span(axis, span)
    axis.set_ylim(len(methods) - 0.4, -0.6)
    axis.set_yticks([])
    plain(axis, grid="x")
    size = min(5.0, 110.0 / max(len(methods), 1) + 2.0)
    for row, method in enumerate(methods):
        if not np.isfinite(group.mean[method]):
            axis.text(
                0.02, row, "no value", transform=axis.get_yaxis_transform(), va="center",
                fontsize=SMALL - 1, color=REST, style="italic",
            )  # fmt: skip
        else:
            _method(axis, group, method, row, size, span, numbered=len(methods) <= _MOST_NUMBERS)


def _method(
    axis: Axes, group: Verdict, method: int, row: int, size: float, span: Span, *, numbered: bool
) -> None:
    """Draw a mean and its interval; one that leaves the panel ends in a head of an arrow."""
    mean, low, high = (float(each[method]) for each in (group.mean, group.low, group.high))
    role = _role(group, method)
    colour = {"best": BEST, "tied": BEST, "baseline": BLACK}.get(role, REST)
    right = mean
    if low < high:
        right = min(high, span.high)
        shown = [max(low, span.low), right]
        axis.plot(shown, [row, row], color=colour, linewidth=1.2, solid_capstyle="butt", zorder=2)
        for end, edge, head in ((low, span.low, "<"), (high, span.high, ">")):
            if not span.low <= end <= span.high:
                axis.plot(edge, row, head, color=colour, markersize=4, mew=0, clip_on=False)
    axis.plot(
        mean, row, "o", markersize=size, color=colour, clip_on=False, zorder=3,
        markerfacecolor="white" if role == "tied" else colour, markeredgewidth=1.2,
    )  # fmt: skip
    if numbered or role in ("best", "baseline"):
        axis.annotate(
            _number(mean), (right, row), xytext=(5, 0), textcoords="offset points",
            va="center", fontsize=SMALL - 1, color=QUIET if colour == REST else colour,
        )  # fmt: skip


def _number(value: float) -> str:
    """Return a mean with three digits: ``0.0310``, ``4.20``, ``1310``."""
    if value and not 1e-4 <= abs(value) < 1e6:
        return f"{value:.2g}"
    decimals = 2 - math.floor(math.log10(abs(value))) if value else 0
    return f"{value:.{max(0, decimals)}f}"


def _role(group: Verdict, method: int) -> str:
    if group.baseline == method:
        return "baseline"
    return group.marks.get(method, "rest")


def _names(
    axis: Axes,
    beside: Sequence[Verdict],
    methods: Sequence[int],
    names: Sequence[str],
    tall: float,
) -> None:
    """Name the methods to the left of a row of panels; of very many, the best and some more."""
    if not beside:
        return
    best = {method for group in beside for method in group.marked("best")}
    step = math.ceil(len(methods) * 0.6 * _ROW / tall)
    shown: list[int] = []
    rows = range(len(methods))
    for row in sorted(rows, key=lambda row: (methods[row] not in best, row % step)):
        if all(abs(row - other) >= step for other in shown):
            shown.append(row)
    shown.sort()
    axis.set_yticks(shown, [names[methods[row]] for row in shown])
    for text, row in zip(axis.get_yticklabels(), shown, strict=True):
        text.set_color(BEST if methods[row] in best else BLACK)


def _marked(verdicts: Verdicts) -> list[str]:
    """Return the names of methods with the marks in which they differ."""
    marks = [
        (mark, on)
        for mark, on in (("*", verdicts.adapted), ("\N{DEGREE SIGN}", verdicts.ahead))
        if on and len(on) < len(verdicts.methods)
    ]
    return [
        figure_text(label) + "".join(mark for mark, on in marks if place in on)
        for place, label in enumerate(verdicts.methods)
    ]


def _quantity(verdicts: Verdicts, span: Span) -> str:
    metric = verdicts.metric
    scale = "" if span.kind == "linear" else ", logarithmic"
    name = number_name(verdicts, unit_text(metric.unit) if metric.unit else "")
    return figure_text(f"{name}{scale}", across=90)


def _legend(groups: Sequence[Verdict], names: Sequence[str]) -> list[str]:
    """Return what the marks mean: those that there are."""
    roles = {_role(each, method) for each in groups for method in each.ranked}
    units = list(dict.fromkeys(units_text(each.scope) for each in groups))
    interval = any(np.isfinite(each.low).any() for each in groups)
    parts = ["Lines: 95 % intervals" + (f" over {units[0]}" if len(units) == 1 else "")]
    means = [
        text
        for role, text in (
            ("best", "blue: the best"),
            ("tied", "hollow: may be the best"),
            ("baseline", "black: the baseline"),
        )
        if role in roles
    ]
    every = "".join(names)
    marks = [
        text
        for mark, text in (
            ("*", "* not as published"),
            ("\N{DEGREE SIGN}", "\N{DEGREE SIGN} looks at the whole take"),
        )
        if mark in every
    ]
    parts = [*(parts if interval else []), *means]
    text = "; ".join(parts)
    lines = [f"{text[:1].upper()}{text[1:]}."] if parts else []
    return [*lines, f"{'; '.join(marks)}."] if marks else lines
