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
    found: Sequence[Points],
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
    axes, found, marked
        What is drawn: the names, the points of each label, and the places with a mark.
    level
        The noise floor of each label, NaN for one without; None where there is no floor.
    scale
        Along y.
    mark, tolerance
        What was asked for, as the title says it.
    unit
        Of the metric.
    """
    figure = Figure(figsize=(7.6, 4.4), layout="constrained")
    panel = figure.subplots()
    _set_scale(panel, scale, found)
    look = looks((*(one.label for one in found), *axes.labels))
    for one in found:
        _draw_curve(panel, one, scale, look[str(one.label)])
    for floor, colour, _ in _floors(found, level, look):
        panel.axhline(floor, color=colour, linestyle=_DASHES, linewidth=1.0, zorder=1)
    for one in found:
        if one.label in marked.places:
            _draw_mark(panel, one, marked.places[one.label], marked.kinds[one.label], scale)
    panel.set_title(
        figure_text(verdict(marked, axes, mark, tolerance), across=90, lines=3), fontsize="medium"
    )
    panel.set_xlabel(figure_text(axes.x))
    panel.set_ylabel(figure_text(axes.metric) + (f" ({unit})" if unit else ""))
    panel.grid(axis="y", color="0.85", linewidth=0.6)
    panel.set_axisbelow(True)
    panel.spines[["top", "right"]].set_visible(False)
    _legend(figure, found, marked, level, look)
    return figure


def _draw_curve(panel: Panel, one: Points, scale: Scale, look: Look) -> None:
    value = scale.shown(one.value)
    _draw_others(panel, one, value, look)
    curve = one.curve
    panel.errorbar(
        one.x[curve],
        value[curve],
        yerr=reach(one.value, one.low, one.high)[:, curve],
        color=look.colour,
        linestyle="none",
        elinewidth=1.0,
        capsize=2,
    )
    panel.plot(
        one.x[curve],
        value[curve],
        color=look.colour,
        marker=look.marker,
        linestyle=look.line,
        markersize=5,
        linewidth=1.3,
        clip_on=False,
    )


def _draw_others(panel: Panel, one: Points, value: NDArray[np.float64], look: Look) -> None:
    """Draw the points that the curve does not take."""
    off = np.setdiff1d(np.flatnonzero(np.isfinite(value)), one.curve)
    panel.scatter(
        one.x[off],
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
    found: Sequence[Points], level: Mapping[Label, float] | None, look: Mapping[str, Look]
) -> list[tuple[float, str, str]]:
    """Return each noise floor, its colour and its name; one where all curves have the same."""
    known = [(level or {}).get(one.label, np.nan) for one in found]
    if len(found) > 1 and len(set(known)) == 1 and np.isfinite(known[0]):
        return [(known[0], BLACK, "noise floor")]
    return [
        (floor, look[str(one.label)].colour, f"noise floor {one.label}".strip())
        for one, floor in zip(found, known, strict=True)
        if np.isfinite(floor)
    ]


def _draw_mark(panel: Panel, one: Points, place: int, kind: str, scale: Scale) -> None:
    panel.plot(
        one.x[place],
        scale.shown(one.value)[place],
        marker=_SYMBOLS[kind],
        markersize=13,
        markerfacecolor="none",
        markeredgecolor=BLACK,
        markeredgewidth=1.6,
        zorder=5,
        clip_on=False,
    )


def _set_scale(panel: Panel, scale: Scale, found: Sequence[Points]) -> None:
    if scale.logarithmic:
        panel.set_yscale("log")
        panel.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        panel.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        panel.yaxis.set_minor_formatter(NullFormatter())
    if np.isfinite(scale.highest):
        panel.set_ylim(scale.lowest, scale.highest if scale.logarithmic else _top(found, scale))
    deep = sum(int(np.count_nonzero(one.value < scale.lowest)) for one in found)
    if deep:
        told = f"{deep} on the lower edge: 0 or lower than shown"
        panel.text(0.01, 0.02, told, transform=panel.transAxes, fontsize="x-small", color="0.35")


def _top(found: Sequence[Points], scale: Scale) -> float:
    """Return where a linear scale ends: above all intervals that are drawn."""
    ends = [one.value + reach(one.value, one.low, one.high)[1] for one in found]
    known = np.concatenate([one[points.curve] for one, points in zip(ends, found, strict=True)])
    return max(scale.highest, _ROOM * float(np.nanmax(known, initial=0.0)))


def _legend(
    figure: Figure,
    found: Sequence[Points],
    marked: Marks,
    level: Mapping[Label, float] | None,
    look: Mapping[str, Look],
) -> None:
    handles, names = [], []
    for one in found:
        if str(one.label):
            its = look[str(one.label)]
            handles.append(Line2D([], [], color=its.colour, marker=its.marker, linestyle=its.line))
            names.append(f"{one.label}" + ("" if len(one.curve) else " (no value)"))
    for _, colour, name in _floors(found, level, look):
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
