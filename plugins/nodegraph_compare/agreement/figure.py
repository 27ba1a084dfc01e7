"""Bland and Altman's plot: differences of two methods over the means of the two."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_compare.left_out import group_text
from nodegraph_compare.pictures import without_drawing
from nodegraph_mocap import figure_text
from nodegraph_tables.axes import plain
from nodegraph_tables.style import BEST, BLACK, REST, STANDS_OUT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from nodegraph_compare.agreement.limits import Interval, Pair
    from nodegraph_compare.question import Question

_MOST = 12
_PER_ROW = 3


def draw(question: Question, pairs: Sequence[Pair], unit: str) -> Figure:
    """Return a panel per pair that shares a block, at most 12 of them.

    Parameters
    ----------
    question, pairs
        Of the comparison.
    unit
        Of the metric.
    """
    known = [pair for pair in pairs if len(pair.limits.difference)]
    drawn = known[:_MOST]
    if not drawn:
        return without_drawing("no two labels share a block")
    columns = min(len(drawn), _PER_ROW)
    rows = math.ceil(len(drawn) / columns)
    size = (max(3.4 * columns, 5.2), 2.9 * rows + 0.3)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axis in axes[len(drawn) :]:
        axis.remove()
    for axis, pair in zip(axes, drawn, strict=False):
        _panel(axis, pair)
        place = group_text(pair.group, question)
        name = f"{figure_text(pair.first)} \N{MINUS SIGN} {figure_text(pair.second)}"
        axis.set_title(f"{figure_text(place)}\n{name}" if place else name, fontsize=9)
    in_unit = f" ({unit})" if unit else ""
    figure.supxlabel(figure_text(f"mean {question.metric} of the two{in_unit}"), fontsize=10)
    figure.supylabel(figure_text(f"difference{in_unit}"), fontsize=10)
    if len(known) > len(drawn):
        figure.suptitle(f"{len(known) - len(drawn)} more pairs are not drawn", fontsize=8)
    return figure


def _panel(axis: Axes, pair: Pair) -> None:
    limits = pair.limits
    axis.axhline(0.0, color=REST, linewidth=0.8)
    axis.scatter(limits.middle, limits.difference, s=14, color=REST, linewidths=0, alpha=0.8)
    _line(axis, limits.bias, limits.of_bias, BEST, "-", "bias")
    _line(axis, limits.lower, limits.of_lower, STANDS_OUT, "--", "lower limit")
    _line(axis, limits.upper, limits.of_upper, STANDS_OUT, "--", "upper limit")
    if limits.of_slope[0] > 0.0 or limits.of_slope[1] < 0.0:
        ends = np.array([limits.middle.min(), limits.middle.max()])
        heights = limits.bias + limits.slope * (ends - limits.middle.mean())
        axis.plot(ends, heights, color=BLACK, linewidth=1)
    plain(axis)


def _line(axis: Axes, height: float, interval: Interval, colour: str, line: str, name: str) -> None:
    if not math.isfinite(height):
        return
    axis.axhline(height, color=colour, linestyle=line, linewidth=1.2)
    if math.isfinite(interval[0]):
        axis.axhspan(*interval, color=colour, alpha=0.15, linewidth=0)
    axis.annotate(
        f"{name} {height:.3g}", (1.0, height), xycoords=axis.get_yaxis_transform(),
        xytext=(0, 2), textcoords="offset points", ha="right", va="bottom", fontsize=8,
        color=colour,
    )  # fmt: skip
