"""Draws shapes over their references."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from nodegraph_mocap import figure_text
from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.view import frontal
from nodegraph_tables.style import BLUE, GREY, LIGHT, ORANGE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

_ACROSS = 4
_SIDE = 2.7
_MARGIN = 0.1
_LETTERS = 30
"""Letters in a line above a panel."""

_FEW = 12
"""Points, above which dots and lines are finer."""

_KINDS = (("reference", ORANGE, 3.2), ("shape", BLUE, 1.2))
_DECIMALS = 9
"""Decimals of D; further ones are rounding."""


def draw(pairs: dict[str, tuple[Trajectories, Trajectories]], frame: int, view: str) -> Figure:
    """Return the figure: a panel per shape."""
    rows = -(-len(pairs) // _ACROSS)
    columns = -(-len(pairs) // rows)
    size = (_SIDE * max(columns, 2), _SIDE * rows + 0.6)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    for axis, (name, (shape, reference)) in zip(axes, pairs.items(), strict=False):
        _panel(axis, name, shape, reference, frame, view)
    for axis in axes[len(pairs) :]:
        axis.set_axis_off()
    handles = [_handle(*kind) for kind in _KINDS]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _panel(
    axis: Axes, name: str, shape: Trajectories, reference: Trajectories, frame: int, view: str
) -> None:
    seen = frontal(reference, view)
    flat = np.stack([seen.right, seen.up], axis=1)
    drawn = []
    scale = 1.0 if len(reference.markers) <= _FEW else 0.4
    # The wider one lies below: it can be seen where the two are the same.
    for outline, (what, colour, wide) in zip((reference, shape), _KINDS, strict=True):
        width = wide * scale
        points = outline.positions[frame if outline.frames > 1 else 0] @ flat
        drawn.append(points)
        axis.add_collection(
            LineCollection(_joined(outline, points), colors=colour, linewidths=width)
        )
        size = 3.5 * scale + width
        axis.plot(*points.T, "o", color=colour, markersize=size, markeredgewidth=0, label=what)
    apart, squared = _apart(name, shape, reference, frame)
    axis.add_collection(LineCollection(list(apart @ flat), colors=GREY, linewidths=0.6, zorder=1))
    distance = f"D = {round(squared, _DECIMALS):.4g}" if len(apart) else "no point is in both"
    called = figure_text(name, across=_LETTERS, lines=2)
    axis.set_title(f"{called}\n{distance}".lstrip("\n"), fontsize="medium")
    _frame(axis, np.concatenate(drawn))


def _handle(what: str, colour: str, wide: float) -> Line2D:
    return Line2D(
        [], [], color=colour, marker="o", markersize=3.5 + wide, linewidth=wide, label=what
    )


def _joined(shape: Trajectories, points: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Return both ends of every line of a shape that has them."""
    round_trip = np.roll(np.arange(len(points)), -1)
    ends = np.column_stack([np.arange(len(points)), round_trip])
    if shape.marker_set is not None:
        ends = np.array(edges_of(shape), dtype=np.intp).reshape(-1, 2)
    lines = points[ends]
    return list(lines[np.isfinite(lines).all(axis=(1, 2))])


def _apart(
    name: str, shape: Trajectories, reference: Trajectories, frame: int
) -> tuple[NDArray[np.float64], float]:
    """Return both ends of the line from each point to the reference's, and their D."""
    shared = [marker for marker in shape.markers if marker in set(reference.markers)]
    if not shared:
        of = f"{name}: the" if name else "the"
        raise ValueError(f"{of} shape and its reference have no marker in common")
    ends = [
        recording.keep(shared).positions[frame if recording.frames > 1 else 0]
        for recording in (shape, reference)
    ]
    lines = np.stack(ends, axis=1)
    known = lines[np.isfinite(lines).all(axis=(1, 2))]
    return known, float(np.sum((known[:, 0] - known[:, 1]) ** 2))


def _frame(axis: Axes, points: NDArray[np.float64]) -> None:
    """Show all points, and where the origin is if it is near."""
    there = points[np.isfinite(points).all(axis=1)]
    low, high = (there.min(axis=0), there.max(axis=0)) if len(there) else (-np.ones(2), np.ones(2))
    size = max(float(np.max(high - low)), 1e-9)
    middle, half = (low + high) / 2, size * (0.5 + _MARGIN)
    axis.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    axis.axhline(0.0, color=LIGHT, linewidth=0.6, zorder=0)
    axis.axvline(0.0, color=LIGHT, linewidth=0.6, zorder=0)
    axis.set_aspect("equal")
    axis.tick_params(labelsize="small")
    # without those at the ends, names of ticks do not meet those of the next panel
    axis.locator_params(nbins=6, prune="both")
    axis.spines[:].set(color="0.88", linewidth=0.6)
