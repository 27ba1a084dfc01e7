"""Notes on curves: what the columns of their table mean, and what is left out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from nodegraph_compare.blocks import unsuccessful
from nodegraph_compare.inference import CONFIDENCE
from nodegraph_compare.left_out import absences, start_text
from nodegraph_tables.numbers import number_text

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_compare.curve.curves import Curves
    from nodegraph_mocap import Table


def verdict(curves: Curves) -> str:
    """Return the title of a figure of curves; an empty text unless minima are to be shared."""
    shared, x = curves.marked.shared, curves.axes.x
    if curves.mark != "shared":
        return ""
    if shared is None:
        return f"no minimum shared within {curves.tolerance:g} {x}"
    return f"minimum shared at {shared:g} {x}"


def most_text(curves: Curves) -> str:
    """Return the error that is small enough."""
    assert curves.enough is not None
    return number_text(curves.enough, curves.unit)


def notes(curves: Curves) -> list[str]:
    """Return what the columns of the table mean."""
    axes = curves.axes
    if axes.blocks:
        text = (
            f"{axes.metric}: mean over blocks, a block being one combination of "
            f"{', '.join(axes.blocks)}; low, high: "
        )
        if axes.units:
            further = " and ".join(axes.units)
            same = "" if axes.units == axes.clusters else " of the same recording"
            text += f"its {100 * CONFIDENCE:.0f} % interval for further {further}{same}."
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
    if curves.enough is not None:
        sentences.append(
            f"enough: the point of a curve from which on its {axes.metric} is at most "
            f"{most_text(curves)}."
        )
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
