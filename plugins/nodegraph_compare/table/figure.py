"""The picture of a comparison: means over blocks with their intervals."""

from __future__ import annotations

import math
from collections import defaultdict
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from nodegraph_compare.pictures import reach, turned
from nodegraph_mocap import figure_text
from nodegraph_tables.style import PALE, unit_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph import Declared, Label
    from nodegraph_compare.question import Question
    from nodegraph_compare.table.summary import Summary
    from nodegraph_tables.style import Look

_WIDEST_LINEAR = 30.0
_PANELS_PER_ROW = 3
_SPREAD = 0.76
_MOST_PANELS = 24
_MOST_TICKS = 40
_MOST_NAMES = 40


def draw(
    question: Question,
    summaries: Sequence[Summary],
    look: Mapping[Label, Look],
    unit: str,
    declared: Mapping[Label, Declared],
) -> Figure:
    """Return the figure: the last of `within` along x, a panel per combination of the others.

    Without `within`, the methods stand along x. A method looks the same in every panel. The
    scale is logarithmic where the means span more than a factor of 30. At most 24 panels.

    Parameters
    ----------
    question, summaries
        Of the comparison.
    look
        Of each compared label, in the order in which they are drawn.
    unit
        Of the metric.
    declared
        What the methods declare.
    """
    marked = _marked(look, declared)
    if not question.within:
        return _one_group(question, summaries, look, unit, marked)
    panels: dict[tuple[Label, ...], list[Summary]] = defaultdict(list)
    for summary in summaries:
        panels[summary.group.labels[:-1]].append(summary)
    places = list(dict.fromkeys(summary.group.labels[-1] for summary in summaries))
    drawn = list(panels.items())[:_MOST_PANELS]
    figure, axes = _grid(len(drawn), len(places) * max(len(look), 2))
    for axis, (labels, panel) in zip(axes, drawn, strict=True):
        _panel(axis, panel, places, look)
        pairs = zip(question.within[:-1], labels, strict=True)
        axis.set_title(figure_text(", ".join(f"{name} {label}" for name, label in pairs)))
        axis.set_xlabel(figure_text(question.within[-1]))
    if len(drawn) < len(panels):
        figure.supxlabel(f"{len(panels) - len(drawn)} more panels are not drawn", fontsize=8)
    _scale(axes, summaries)
    for axis in axes[::_PANELS_PER_ROW]:
        axis.set_ylabel(_quantity(question, unit))
    _legend(figure, summaries, look, marked)
    return figure


def _marked(look: Mapping[Label, Look], declared: Mapping[Label, Declared]) -> dict[Label, str]:
    """Return the names of methods with the marks in which they differ."""
    adapted = {label for label, each in declared.items() if "adapted" in each}
    whole = {label for label, each in declared.items() if each.get("lookahead", 0) is None}
    marks = [
        (mark, on)
        for mark, on in (("*", adapted), ("\N{DEGREE SIGN}", whole))
        if on and len(on) < len(look)
    ]
    return {
        label: figure_text(label) + "".join(mark for mark, on in marks if label in on)
        for label in look
    }


def _one_group(
    question: Question,
    summaries: Sequence[Summary],
    look: Mapping[Label, Look],
    unit: str,
    marked: Mapping[Label, str],
) -> Figure:
    order = tuple(look)
    figure, (axis,) = _grid(1, len(order) * 2)
    for summary in summaries:
        for place, label in enumerate(order):
            if label in summary.group.methods:
                _point(axis, np.array([place]), [summary], label, look[label])
    _ticks(
        axis,
        [marked[label] for label in order],
        turn=len(order) > 4 or any(len(str(label)) > 12 for label in order),
    )
    axis.set_xlim(-0.6, len(order) - 0.4)
    _scale([axis], summaries)
    axis.set_xlabel(figure_text(question.compare or ""))
    axis.set_ylabel(_quantity(question, unit))
    return figure


def _grid(panels: int, points: int) -> tuple[Figure, list[Axes]]:
    columns = max(1, min(panels, _PANELS_PER_ROW))
    rows = max(1, math.ceil(panels / columns))
    width = min(max(3.4, 1.2 + 0.17 * points), 11.0 / columns)
    figure = Figure(figsize=(max(columns * width, 4.2), 3.1 * rows + 0.6), layout="constrained")
    axes = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for axis in axes[panels:]:
        axis.remove()
    return figure, list(axes[: max(panels, 1)])


def _panel(
    axis: Axes, summaries: Sequence[Summary], places: list[Label], look: Mapping[Label, Look]
) -> None:
    offsets = (np.arange(len(look)) - (len(look) - 1) / 2) * _SPREAD / max(len(look), 1)
    for offset, label in zip(offsets, look, strict=True):
        having = [summary for summary in summaries if label in summary.group.methods]
        x = np.array([places.index(summary.group.labels[-1]) + offset for summary in having])
        _point(axis, x, having, label, look[label])
    for place in range(1, len(places), 2):
        axis.axvspan(place - 0.5, place + 0.5, color=PALE, alpha=0.6, linewidth=0, zorder=0)
    letters = sum(len(str(place)) + 1 for place in places)
    _ticks(axis, [figure_text(place) for place in places], turn=letters > 45)
    axis.set_xlim(-0.5, len(places) - 0.5)


def _ticks(axis: Axes, labels: Sequence[str], *, turn: bool) -> None:
    """Name the places along x; of many, some."""
    step = math.ceil(len(labels) / _MOST_TICKS) or 1
    named = range(0, len(labels), step)
    axis.set_xticks(named, [labels[place] for place in named])
    if turn:
        turned(axis)


def _point(
    axis: Axes, x: NDArray[np.float64], having: Sequence[Summary], label: Label, look: Look
) -> None:
    """Draw the means of one method; no bar where there is no interval."""
    columns = [summary.group.methods.index(label) for summary in having]
    at = list(zip(having, columns, strict=True))
    mean, low, high = (
        np.array([getattr(summary, name)[column] for summary, column in at])
        for name in ("mean", "low", "high")
    )
    axis.errorbar(
        x,
        mean,
        yerr=reach(mean, low, high),
        color=look.colour,
        marker=look.marker,
        markersize=5,
        linestyle="none",
        elinewidth=1.3,
        capsize=2,
        label=str(label),
    )


def _scale(axes: Sequence[Axes], summaries: Sequence[Summary]) -> None:
    means = np.concatenate([summary.mean for summary in summaries]) if summaries else np.empty(0)
    means = means[np.isfinite(means)]
    wide = len(means) and means.min() > 0 and means.max() > _WIDEST_LINEAR * means.min()
    for axis in axes:
        if wide:
            axis.set_yscale("log")
            axis.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
            axis.yaxis.set_minor_formatter(NullFormatter())
        elif len(means) and means.min() >= 0:
            axis.set_ylim(bottom=0)
        axis.grid(axis="y", color="0.85", linewidth=0.6)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)


def _legend(
    figure: Figure,
    summaries: Sequence[Summary],
    look: Mapping[Label, Look],
    marked: Mapping[Label, str],
) -> None:
    order = tuple(look)
    known = {
        label
        for summary in summaries
        for label, blocks in zip(summary.group.methods, summary.blocks, strict=True)
        if blocks
    }
    handles = [_handle(look[label]) for label in order[:_MOST_NAMES]]
    names = [marked[label] + ("" if label in known else " (no value)") for label in order]
    if len(order) > _MOST_NAMES:
        names[_MOST_NAMES - 1] += f", and {len(order) - _MOST_NAMES} more"
    if len(order) > 1:
        figure.legend(handles, names[:_MOST_NAMES], loc="outside right upper", frameon=False)


def _handle(look: Look) -> Line2D:
    return Line2D([], [], color=look.colour, marker=look.marker, markersize=5, linestyle="none")


def _quantity(question: Question, unit: str) -> str:
    return figure_text(f"mean {question.metric}" + (f" ({unit_text(unit)})" if unit else ""))
