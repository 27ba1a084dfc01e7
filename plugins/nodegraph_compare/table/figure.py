"""The picture of a comparison: means over blocks with their intervals."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_compare.left_out import group_text
from nodegraph_compare.pictures import Span, set_span, span_of, without_drawing
from nodegraph_compare.scope import unit_text as units_text
from nodegraph_mocap import figure_text
from nodegraph_tables.axes import SMALL, plain
from nodegraph_tables.style import BEST, BLACK, QUIET, REST, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes

    from nodegraph import Declared, Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary

_MOST_PANELS = 24
_MOST_ACROSS = 4
_ROW = 0.19
_TALLEST = 7.6
"""Inches: a row of a method, and all rows of a panel at most."""

_MOST_NUMBERS = 40
"""Methods up to which the mean of each is written next to its interval."""

_GAP_ACROSS, _GAP_DOWN, _BELOW = 0.28, 0.42, 0.55
_LETTERS = 34
"""In a line above a panel."""


def draw(
    question: Question,
    summaries: Sequence[Summary],
    order: Sequence[Label],
    unit: str,
    declared: Mapping[Label, Declared],
) -> Figure:
    """Return the figure: a panel per group, in each a row per method.

    The last of `within` lies across. The methods have one order in all panels: by their mean
    place, where one end of the metric is better. At most 24 panels.

    Parameters
    ----------
    question, summaries
        Of the comparison.
    order
        Every compared label.
    unit
        Of the metric.
    declared
        What the methods declare.
    """
    if not summaries:
        return without_drawing("nothing to compare")
    drawn = [_printed(summary, scale_of(unit)) for summary in summaries[:_MOST_PANELS]]
    methods = _ordered(summaries, order)
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
    names = _marked(methods, declared)
    for place, summary in enumerate(drawn):
        column, row = place % across, place // across
        bottom = height - (row + 1) * (tall + _GAP_DOWN)
        axis = figure.add_axes(
            (column * (wide + _GAP_ACROSS) / width, bottom / height, wide / width, tall / height)
        )
        _panel(axis, summary, methods, span)
        title = figure_text(group_text(summary.group, question), across=_LETTERS, lines=2)
        axis.set_title(title, fontsize=SMALL + 1, loc="left", pad=4)
        beside = drawn[place - column : place - column + across]
        _names(axis, beside if column == 0 else [], methods, names, tall)
        if place + across < len(drawn):
            axis.tick_params(axis="x", labelbottom=False)
    notes = [_quantity(question, unit, span), *_legend(question, drawn, names)]
    if len(drawn) < len(summaries):
        notes.append(f"{len(summaries) - len(drawn)} more panels are not drawn")
    figure.text(
        0, (_BELOW - 0.34) / height, "\n".join(notes), fontsize=SMALL, color=QUIET, va="top"
    )
    return figure


def _printed(summary: Summary, scale: float) -> Summary:
    """Return a summary whose numbers are those that are printed."""
    mean, low, high = (scale * each for each in (summary.mean, summary.low, summary.high))
    return replace(summary, mean=mean, low=low, high=high)


def _across(summaries: Sequence[Summary]) -> int:
    """Return how many panels are side by side: those of the last axis, if they fit."""
    last = dict.fromkeys(summary.group.labels[-1:] for summary in summaries)
    rows = math.ceil(len(last) / _MOST_ACROSS)
    return math.ceil(len(last) / rows)


def _ordered(summaries: Sequence[Summary], order: Sequence[Label]) -> list[Label]:
    """Return the methods by their mean place over all groups, those without a number last."""
    places: dict[Label, list[float]] = defaultdict(list)
    for summary in summaries:
        known = [at for at in summary.ranked if np.isfinite(summary.level[at])]
        for place, at in enumerate(known):
            places[summary.group.methods[at]].append(place)
    if any(summary.end == "none" for summary in summaries):
        return list(order)
    return sorted(order, key=lambda label: np.mean(places[label] or [math.inf]))


def _span(summaries: Sequence[Summary]) -> Span:
    return span_of(
        np.concatenate([summary.mean for summary in summaries]),
        np.concatenate([summary.low for summary in summaries]),
        np.concatenate([summary.high for summary in summaries]),
    )


def _panel(axis: Axes, summary: Summary, methods: Sequence[Label], span: Span) -> None:
    set_span(axis, span)
    axis.set_ylim(len(methods) - 0.4, -0.6)
    axis.set_yticks([])
    plain(axis, grid="x")
    at = {label: column for column, label in enumerate(summary.group.methods)}
    size = min(5.0, 110.0 / max(len(methods), 1) + 2.0)
    for row, label in enumerate(methods):
        column = at.get(label)
        if column is None or not np.isfinite(summary.mean[column]):
            axis.text(
                0.02, row, "no value", transform=axis.get_yaxis_transform(), va="center",
                fontsize=SMALL - 1, color=REST, style="italic",
            )  # fmt: skip
        else:
            _method(axis, summary, column, row, size, span, numbered=len(methods) <= _MOST_NUMBERS)


def _method(
    axis: Axes, summary: Summary, column: int, row: int, size: float, span: Span, *, numbered: bool
) -> None:
    """Draw a mean and its interval; one that leaves the panel ends in a head of an arrow."""
    mean, low, high = (float(each[column]) for each in (summary.mean, summary.low, summary.high))
    role = _role(summary, column)
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


def _role(summary: Summary, column: int) -> str:
    if summary.against == column:
        return "baseline"
    if summary.marked[column]:
        return "best"
    tied = summary.judged and summary.to_best is not None and not summary.behind[column]
    return "tied" if tied else "rest"


def _names(
    axis: Axes,
    beside: Sequence[Summary],
    methods: Sequence[Label],
    names: Mapping[Label, str],
    tall: float,
) -> None:
    """Name the methods to the left of a row of panels; of very many, the best and some more."""
    if not beside:
        return
    best = {
        summary.group.methods[column]
        for summary in beside
        for column in np.flatnonzero(summary.marked)
    }
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


def _marked(methods: Sequence[Label], declared: Mapping[Label, Declared]) -> dict[Label, str]:
    """Return the names of methods with the marks in which they differ."""
    adapted = {label for label, each in declared.items() if "adapted" in each}
    whole = {label for label, each in declared.items() if each.get("lookahead", 0) is None}
    marks = [
        (mark, on)
        for mark, on in (("*", adapted), ("\N{DEGREE SIGN}", whole))
        if on and len(on) < len(methods)
    ]
    return {
        label: figure_text(label) + "".join(mark for mark, on in marks if label in on)
        for label in methods
    }


def _quantity(question: Question, unit: str, span: Span) -> str:
    in_unit = f" ({unit_text(unit)})" if unit else ""
    scale = "" if span.kind == "linear" else ", logarithmic"
    return figure_text(f"mean {question.metric}{in_unit}{scale}", across=90)


def _legend(
    question: Question, summaries: Sequence[Summary], names: Mapping[Label, str]
) -> list[str]:
    """Return what the marks mean: those that there are."""
    roles = {_role(each, column) for each in summaries for column in range(len(each.mean))}
    units = list(dict.fromkeys(units_text(each.units, question) for each in summaries))
    interval = any(np.isfinite(each.low).any() for each in summaries)
    parts = ["Lines: 95 % intervals" + (f" over {units[0]}" if len(units) == 1 else "")]
    means = [
        text
        for role, text in (
            ("best", "blue: the best"),
            ("tied", "hollow: not clearly behind it"),
            ("baseline", "black: the baseline"),
        )
        if role in roles
    ]
    every = "".join(names.values())
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
