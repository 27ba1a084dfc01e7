"""How points are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_mocap import figure_text
from nodegraph_tables.axes import plain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_tables.style import Look

_MANY = 5000
"""Points from which on they are drawn as one picture, so that the file stays small."""
_WIDE = 100.0
_LETTERS = 24
"""In a line of the legend."""


def draw(
    points: dict[str, NDArray[np.float64]], look: dict[str, Look], right: str, up: str
) -> Figure:
    """Return the figure: the points of each label in its colour."""
    figure = Figure(figsize=(7.0, 4.4), layout="constrained")
    axis = figure.subplots()
    many = sum(map(len, points.values())) > _MANY
    for name, values in points.items():
        axis.scatter(
            values[:, 0],
            values[:, 1],
            s=12,
            alpha=0.45 if many else 0.7,
            color=look[name].colour,
            marker=look[name].marker,
            linewidths=0,
            label=figure_text(name or up, across=_LETTERS, lines=2),
            rasterized=many,
        )
    together = np.concatenate(list(points.values()))
    axis.set(xlabel=figure_text(right), ylabel=figure_text(up))
    axis.set(xscale=_scale(together[:, 0]), yscale=_scale(together[:, 1]))
    plain(axis, grid="both")
    if len(points) > 1:
        figure.legend(loc="outside right upper", frameon=False)
    return figure


def _scale(values: NDArray[np.float64]) -> str:
    positive = len(values) and values.min() > 0
    return "log" if positive and values.max() > _WIDE * values.min() else "linear"
