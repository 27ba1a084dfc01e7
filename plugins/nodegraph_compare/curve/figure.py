"""The picture of curves: one in the foreground of each panel, its noise floor and its mark."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from nodegraph_compare.curve.notes import most_text, verdict
from nodegraph_compare.pictures import reach
from nodegraph_mocap import figure_text
from nodegraph_tables.axes import SMALL, plain
from nodegraph_tables.style import BLACK, LINE, QUIET, REST, scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes as Panel

    from nodegraph_compare.curve.curves import Curves
    from nodegraph_compare.curve.points import Points
    from nodegraph_compare.curve.scale import Scale


_MOST_PANELS = 24
_MOST_ACROSS = 4
_MOST_BEHIND = 12
"""Curves up to which all others stand behind the one of a panel."""

_SYMBOLS = {"shared": "o", "minimum": "o", "knee": "s", "enough": "o"}
_MEANINGS = {
    "shared": "shared minimum", "minimum": "lowest minimum", "knee": "knee", "enough": "enough",
}  # fmt: skip
_ROOM = 1.05
_LETTERS = 24
"""Letters in a line above a panel."""


def draw(curves: Curves) -> Figure:
    """Return the figure: a panel per curve, at most 24, on one scale.

    In each, the curve is black, with the points that it does not take hollow, a ring or a square
    around its mark, its noise floor shaded and what is enough dashed; the others are grey.
    """
    drawn = curves.points[:_MOST_PANELS]
    across = min(len(drawn), _MOST_ACROSS)
    down = math.ceil(len(drawn) / across)
    width = {1: 6.4, 2: 3.9}.get(across, 2.6)
    tall = 3.6 if len(drawn) == 1 else 2.2
    figure = Figure(figsize=(across * width, down * tall + 0.5), layout="constrained")
    grid = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
    panels = grid.ravel()
    _set_scale(panels[0], curves)
    for panel, points in zip(panels, drawn, strict=False):
        _draw_panel(panel, points, curves)
    for panel in panels[len(drawn) :]:
        panel.remove()
    title, axes = verdict(curves), curves.axes
    if title:
        figure.suptitle(figure_text(title, across=90, lines=3), x=0.01, ha="left", fontsize=10)
    in_unit = f" ({unit_text(curves.unit)})" if curves.unit else ""
    notes = [f"{axes.metric}{in_unit} over {axes.x}", *_notes(drawn, curves)]
    figure.supxlabel(
        figure_text(". ".join(notes), across=110, lines=4), x=0.01, ha="left", fontsize=SMALL,
        color=QUIET,
    )  # fmt: skip
    return figure


def _draw_panel(panel: Panel, points: Points, curves: Curves) -> None:
    plain(panel)
    scale = curves.scale
    for other in curves.points if len(curves.points) <= _MOST_BEHIND else ():
        if other is not points and len(other.curve):
            panel.plot(
                other.x[other.curve], scale.shown(other.value)[other.curve], color=REST,
                linewidth=0.6, alpha=0.5, clip_on=False, zorder=1.5,
            )  # fmt: skip
    floor = curves.floor(points)
    if math.isfinite(floor):
        panel.axhspan(min(panel.get_ylim()[0], floor), floor, color=LINE, alpha=0.7, zorder=0.5)
        # a floor above all that is drawn would push the layout apart
        panel.text(
            0.01, floor, "noise floor", transform=panel.get_yaxis_transform(), fontsize=SMALL - 1,
            color=QUIET, va="bottom", clip_on=True, in_layout=False,
        )  # fmt: skip
    if curves.enough is not None:
        panel.axhline(curves.enough, color=QUIET, linewidth=0.8, linestyle="--", zorder=1)
    _draw_curve(panel, points, scale)
    name = str(points.label) + ("" if len(points.curve) else " (no value)")
    panel.set_title(
        figure_text(name, across=_LETTERS, lines=2), loc="left", fontsize=SMALL + 1, color=BLACK
    )
    if points.label in curves.marked.places:
        _draw_mark(panel, points, curves)


def _draw_curve(panel: Panel, points: Points, scale: Scale) -> None:
    value = scale.shown(points.value)
    off = np.setdiff1d(np.flatnonzero(np.isfinite(value)), points.curve)
    panel.scatter(
        points.x[off], value[off], s=11, facecolors="none", edgecolors=BLACK, alpha=0.55,
        linewidths=0.8, clip_on=False,
    )  # fmt: skip
    curve = points.curve
    if not len(curve):  # a line without points would count as one at the corner of the figure
        return
    panel.errorbar(
        points.x[curve],
        value[curve],
        yerr=reach(points.value, points.low, points.high)[:, curve],
        color=BLACK,
        linestyle="none",
        elinewidth=1.0,
    )
    panel.plot(
        points.x[curve], value[curve], "o-", color=BLACK, markersize=3.5, linewidth=1.5,
        label=str(points.label), clip_on=False, zorder=3,
    )  # fmt: skip


def _draw_mark(panel: Panel, points: Points, curves: Curves) -> None:
    place, kind = curves.marked.places[points.label], curves.marked.kinds[points.label]
    x, y = points.x[place], curves.scale.shown(points.value)[place]
    panel.plot(
        x, y, marker=_SYMBOLS[kind], markersize=11, markerfacecolor="none", markeredgecolor=BLACK,
        markeredgewidth=1.3, zorder=5, clip_on=False,
    )  # fmt: skip
    panel.annotate(
        f"{_MEANINGS[kind]} {x:g}", (x, y), xytext=(7, 7), textcoords="offset points",
        fontsize=SMALL - 1, color=BLACK, zorder=6,
    )  # fmt: skip


def _notes(drawn: Sequence[Points], curves: Curves) -> list[str]:
    scale = curves.scale
    notes = ["Logarithmic"] if scale.logarithmic else []
    if any(len(points.curve) < np.isfinite(points.value).sum() for points in drawn):
        notes.append("Hollow: points that the curve does not take")
    if any(math.isfinite(floor) for floor in (curves.floors or {}).values()):
        notes.append("Shaded: what noise alone does")
    if curves.enough is not None:
        notes.append(f"Dashed: {most_text(curves)}, which is enough")
    deep = sum(int(np.count_nonzero(points.value < scale.lowest)) for points in curves.points)
    if deep:
        notes.append(f"{deep} on the lower edge: 0 or lower than shown")
    if len(drawn) < len(curves.points):
        notes.append(f"{len(curves.points) - len(drawn)} more curves are not drawn")
    return notes


def _set_scale(panel: Panel, curves: Curves) -> None:
    scale, times = curves.scale, scale_of(curves.unit)
    if scale.logarithmic:
        panel.set_yscale("log")
        panel.yaxis.set_major_locator(LogLocator(numticks=6))
        panel.yaxis.set_minor_formatter(NullFormatter())
    else:
        panel.yaxis.set_major_locator(MaxNLocator(5))
    if scale.logarithmic or times != 1.0:
        panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{times * value:g}"))
    if np.isfinite(scale.highest):
        panel.set_ylim(scale.lowest, scale.highest if scale.logarithmic else _top(curves))
    panel.xaxis.set_major_locator(MaxNLocator(5))


def _top(curves: Curves) -> float:
    """Return where a linear scale ends: above all intervals that are drawn."""
    ends = [
        points.value + reach(points.value, points.low, points.high)[1] for points in curves.points
    ]
    known = np.concatenate(
        [end[points.curve] for end, points in zip(ends, curves.points, strict=True)]
    )
    return max(curves.scale.highest, _ROOM * float(np.nanmax(known, initial=0.0)))
