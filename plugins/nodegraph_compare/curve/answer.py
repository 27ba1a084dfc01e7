"""Sentences on curves: where their marks are, what noise alone does, what is left out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_compare.blocks import unsuccessful
from nodegraph_compare.inference import CONFIDENCE
from nodegraph_compare.left_out import absences, start_text
from nodegraph_compare.ties import at_most
from nodegraph_tables.style import scale_of, unit_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from nodegraph import Across
    from nodegraph_compare.curve.curves import Curves
    from nodegraph_compare.curve.points import Points
    from nodegraph_mocap import Table


def answer(curves: Curves) -> list[str]:
    """Return sentences: the marked or the lowest points, then the points that reach the noise."""
    drawn = curves.drawn
    if not drawn:
        return [f"No point has a number for {curves.axes.metric}; nothing can be said."]
    sentences = _Sentences(curves)
    under = [points for points in drawn if math.isfinite(curves.floor(points))]
    lines = [] if curves.mark == "none" else sentences.marks()
    lines += sentences.lowest() if curves.mark == "none" and not under else []
    return [*lines, *(sentences.floor(points) for points in under)]


def verdict(curves: Curves) -> str:
    """Return the title of a figure of curves; an empty text unless minima are to be shared."""
    shared, x = curves.marked.shared, curves.axes.x
    if curves.mark != "shared":
        return ""
    if shared is None:
        return f"no minimum shared within {curves.tolerance:g} {x}"
    return f"minimum shared at {shared:g} {x}"


def notes(curves: Curves, units: tuple[str, ...]) -> list[str]:
    """Return what the columns of the table mean.

    Parameters
    ----------
    curves
    units
        What distinguishes independent units.
    """
    axes = curves.axes
    if axes.blocks:
        text = (
            f"{axes.metric}: mean over blocks, a block being one combination of "
            f"{', '.join(axes.blocks)}; low, high: "
        )
        if units:
            further = "" if units == axes.clusters else " of the same recording"
            text += (
                f"its {100 * CONFIDENCE:.0f} % interval for further {' and '.join(units)}{further}."
            )
        else:
            text += "none, as all blocks are of one recording."
    else:
        text = f"{axes.metric}: of one row, or the mean where rows says that there are more."
    sentences = [f"{text} Lower is better."]
    if axes.lowest:
        sentences.append(f"on curve: the lowest of the points at one value of {axes.x}.")
    sentences.append("local minimum: lower than the points of the curve before and after it.")
    if curves.floors is not None:
        sentences.append("below floor: at or below what measurement noise alone does.")
    if "knee" in curves.marked.kinds.values():
        sentences.append(
            "knee: the point of a curve farthest below the straight line through its first and "
            "last point, on the scales of the figure; errors below the noise floor count as it."
        )
    return sentences


def losses(scores: Across[Table], curves: Curves, *, skipped: bool) -> list[str]:
    """Return counts of what is left out.

    Parameters
    ----------
    scores
        The gathered tables.
    curves
    skipped
        Whether to list what the graph leaves out on purpose.
    """
    axes = curves.axes
    rows = "blocks" if axes.blocks else "rows"
    sentences = [
        f"{start_text(points.label)}{count} {what}"
        for points in curves.points
        for count, what in (
            (points.without_x, f"rows left out, whose {axes.x} is not a finite number"),
            (points.without_value, f"{rows} left out, whose {axes.metric} is not a finite number"),
        )
        if count
    ]
    sentences += [
        f"{start_text(points.label)}{points.taken} {rows} as by the fallback"
        for points in curves.points
        if skipped and points.taken
    ]
    lacking = [str(points.label) for points in curves.points if len(points.curve) == 0]
    sentences += [f"without a curve: {', '.join(lacking)}"] if any(lacking) else []
    if curves.floors is not None:
        bare = [str(points.label) for points in curves.points if math.isnan(curves.floor(points))]
        sentences += [f"without a noise floor: {', '.join(bare)}"] if bare else []
    absent = scores.absent if skipped else unsuccessful(scores)
    return sentences + absences(absent, axes.compare)


class _Sentences:
    """Sentences on the curves of one figure."""

    def __init__(self, curves: Curves) -> None:
        self._curves, self._axes, self._marked = curves, curves.axes, curves.marked

    def lowest(self) -> list[str]:
        places = (
            (points, points.curve[int(np.argmin(points.value[points.curve]))])
            for points in self._curves.drawn
        )
        return [f"Lowest: {self._points(places)}."]

    def marks(self) -> list[str]:
        drawn, tolerance = self._curves.drawn, self._curves.tolerance
        of = {
            kind: [
                (points, self._marked.places[points.label])
                for points in drawn
                if self._marked.kinds.get(points.label) == kind
            ]
            for kind in ("shared", "minimum", "knee")
        }
        sentences = []
        if of["shared"]:
            sentences.append(
                f"All {len(drawn)} curves have a local minimum within {tolerance:g} of "
                f"{self._axes.x} {self._marked.shared:g}, the fewest of which this holds: "
                f"{self._points(of['shared'])}."
            )
        elif self._curves.mark == "shared":
            sentences.append(
                f"No local minimum is shared within {tolerance:g} {self._axes.x}:"
                f" {self._minima(drawn)}."
            )
        if of["minimum"]:
            sentences.append(f"Lowest local minimum: {self._points(of['minimum'])}.")
        if of["knee"]:
            sentences.append(f"Knees, marked instead: {self._points(of['knee'])}.")
        bare = [_name(points) for points in drawn if points.label not in self._marked.places]
        if bare:
            sentences.append(f"Neither a minimum to mark nor a knee: {', '.join(bare)}.")
        return sentences

    def floor(self, points: Points) -> str:
        level = self._curves.floor(points)
        curve = points.curve
        reached = points.x[curve][at_most(points.value[curve], level)]
        start = f"{start_text(points.label)}noise alone gives {self._number(level)}; "
        if not len(reached):
            return f"{start}no point of the curve is as low."
        return (
            f"{start}{len(reached)} of {len(curve)} points of the curve are at or below it, "
            f"first at {self._axes.x} {reached[0]:g}."
        )

    def _minima(self, drawn: Sequence[Points]) -> str:
        clauses = []
        for points in drawn:
            minima = ", ".join(f"{x:g}" for x in points.x[self._marked.minima[points.label]])
            clauses.append(f"{_name(points)} has " + (f"some at {minima}" if minima else "none"))
        return "; ".join(clauses)

    def _points(self, places: Iterable[tuple[Points, int]]) -> str:
        return ", ".join(
            f"{_name(points)} at {points.x[place]:g} ({self._number(points.value[place])}"
            f"{self._reach(points, place)})".strip()
            for points, place in places
        )

    def _reach(self, points: Points, place: int) -> str:
        below = at_most(points.value[place], self._curves.floor(points))
        return ", not above the noise floor" if below else ""

    def _number(self, value: float) -> str:
        unit = self._curves.unit
        return f"{self._axes.metric} {scale_of(unit) * value:.3g} {unit_text(unit)}".rstrip()


def _name(points: Points) -> str:
    return str(points.label) or "the curve"
