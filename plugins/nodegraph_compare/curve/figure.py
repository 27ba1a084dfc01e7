"""The picture of curves: all points, the noise floors, and a ring around what is best."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from nodegraph_compare.curve.answer import verdict
from nodegraph_compare.pictures import reach
from nodegraph_mocap import figure_text
from nodegraph_tables.style import BLACK, looks

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes as Panel
    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.curve.marks import Mark, Marks
    from nodegraph_compare.curve.points import Axes, Points
    from nodegraph_compare.curve.scale import Scale
    from nodegraph_tables.style import Look


_DASHES = (0, (5, 3))
_SYMBOLS = {"shared": "o", "minimum": "o", "knee": "s"}
_ROOM = 1.05
_MEANINGS = {"shared": "shared minimum", "minimum": "lowest minimum", "knee": "knee"}


def draw(
    axes: Axes,
    curves: Sequence[Points],
    marked: Marks,
    level: Mapping[Label, float] | None,
    scale: Scale,
    mark: Mark,
    tolerance: float,
    unit: str,
) -> Figure:
    """Return the figure: points pale, curves through those they take, floors dashed.

    Parameters
    ----------
    axes, curves, marked
        What is drawn: the names, the points of each label, and the places with a mark.
    level
        The noise floor of each label, NaN for one without; None where there is no floor.
    scale
        Along y.
    mark, tolerance
        As set; for the title.
    unit
        Of the metric.
    """
    figure = Figure(figsize=(7.6, 4.4), layout="constrained")
    panel = figure.subplots()
    _set_scale(panel, scale, curves)
    look = looks((*(points.label for points in curves), *axes.labels))
    for points in curves:
        _draw_curve(panel, points, scale, look[str(points.label)])
    for floor, colour, _ in _floors(curves, level, look):
        panel.axhline(floor, color=colour, linestyle=_DASHES, linewidth=1.0, zorder=1)
    for points in curves:
        if points.label in marked.places:
            _draw_mark(panel, points, marked, scale)
    panel.set_title(
        figure_text(verdict(marked, axes, mark, tolerance), across=90, lines=3), fontsize="medium"
    )
    panel.set_xlabel(figure_text(axes.x))
    panel.set_ylabel(figure_text(axes.metric) + (f" ({unit})" if unit else ""))
    panel.grid(axis="y", color="0.85", linewidth=0.6)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)
    _legend(figure, curves, marked, level, look)
    return figure


def _draw_curve(panel: Panel, points: Points, scale: Scale, look: Look) -> None:
    value = scale.shown(points.value)
    _draw_others(panel, points, value, look)
    curve = points.curve
    panel.errorbar(
        points.x[curve],
        value[curve],
        yerr=reach(points.value, points.low, points.high)[:, curve],
        color=look.colour,
        linestyle="none",
        elinewidth=1.0,
        capsize=2,
    )
    panel.plot(
        points.x[curve],
        value[curve],
        color=look.colour,
        marker=look.marker,
        linestyle=look.line,
        markersize=5,
        linewidth=1.3,
        clip_on=False,
    )


def _draw_others(panel: Panel, points: Points, value: NDArray[np.float64], look: Look) -> None:
    """Draw the points that the curve does not take."""
    off = np.setdiff1d(np.flatnonzero(np.isfinite(value)), points.curve)
    panel.scatter(
        points.x[off],
        value[off],
        s=14,
        marker=look.marker,
        facecolors="none",
        edgecolors=look.colour,
        alpha=0.55,
        linewidths=0.8,
        clip_on=False,
    )


def _floors(
    curves: Sequence[Points], level: Mapping[Label, float] | None, look: Mapping[str, Look]
) -> list[tuple[float, str, str]]:
    """Return each noise floor, its colour and its name; one where all curves have the same."""
    known = [(level or {}).get(points.label, np.nan) for points in curves]
    if len(curves) > 1 and len(set(known)) == 1 and np.isfinite(known[0]):
        return [(known[0], BLACK, "noise floor")]
    return [
        (floor, look[str(points.label)].colour, f"noise floor {points.label}".strip())
        for points, floor in zip(curves, known, strict=True)
        if np.isfinite(floor)
    ]


def _draw_mark(panel: Panel, points: Points, marked: Marks, scale: Scale) -> None:
    place = marked.places[points.label]
    panel.plot(
        points.x[place],
        scale.shown(points.value)[place],
        marker=_SYMBOLS[marked.kinds[points.label]],
        markersize=13,
        markerfacecolor="none",
        markeredgecolor=BLACK,
        markeredgewidth=1.6,
        zorder=5,
        clip_on=False,
    )


def _set_scale(panel: Panel, scale: Scale, curves: Sequence[Points]) -> None:
    if scale.logarithmic:
        panel.set_yscale("log")
        panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        panel.yaxis.set_minor_formatter(NullFormatter())
    if np.isfinite(scale.highest):
        panel.set_ylim(scale.lowest, scale.highest if scale.logarithmic else _top(curves, scale))
    deep = sum(int(np.count_nonzero(points.value < scale.lowest)) for points in curves)
    if deep:
        note = f"{deep} on the lower edge: 0 or lower than shown"
        panel.text(0.01, 0.02, note, transform=panel.transAxes, fontsize="x-small", color="0.35")


def _top(curves: Sequence[Points], scale: Scale) -> float:
    """Return where a linear scale ends: above all intervals that are drawn."""
    ends = [points.value + reach(points.value, points.low, points.high)[1] for points in curves]
    known = np.concatenate([end[points.curve] for end, points in zip(ends, curves, strict=True)])
    return max(scale.highest, _ROOM * float(np.nanmax(known, initial=0.0)))


def _legend(
    figure: Figure,
    curves: Sequence[Points],
    marked: Marks,
    level: Mapping[Label, float] | None,
    look: Mapping[str, Look],
) -> None:
    handles, names = [], []
    for points in curves:
        if str(points.label):
            its = look[str(points.label)]
            handles.append(Line2D([], [], color=its.colour, marker=its.marker, linestyle=its.line))
            names.append(f"{points.label}" + ("" if len(points.curve) else " (no value)"))
    for _, colour, name in _floors(curves, level, look):
        handles.append(Line2D([], [], color=colour, linestyle=_DASHES, linewidth=1.0))
        names.append(name)
    for kind in dict.fromkeys(marked.kinds.values()):
        symbol = Line2D([], [], linestyle="none", marker=_SYMBOLS[kind], markersize=10)
        symbol.set(markerfacecolor="none", markeredgecolor=BLACK)
        handles.append(symbol)
        names.append(_MEANINGS[kind])
    if handles:
        figure.legend(
            handles, [figure_text(name) for name in names], loc="outside right upper", frameon=False
        )
