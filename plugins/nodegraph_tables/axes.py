"""Quiet axes for all figures, and the names of lines beside their ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from nodegraph_tables.style import LINE, QUIET

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

SMALL = 8.0
"""Points, of the names of ticks and lines."""

_POINTS = 72.0
_LEADING = 1.15


def plain(axis: Axes, *, grid: Literal["x", "y", "both"] = "y") -> None:
    """Draw axes without a frame and ticks: names of ticks, and a grid behind everything.

    Parameters
    ----------
    axis
    grid
        Across which axes its lines run.
    """
    axis.spines[:].set_visible(False)
    axis.tick_params(which="both", length=0, labelsize=SMALL, labelcolor=QUIET)
    axis.grid(axis=grid, color=LINE, linewidth=0.7)
    axis.set_axisbelow(True)


def name_lines(
    axis: Axes, names: Sequence[str], heights: Sequence[float], colours: Sequence[str], tall: float
) -> None:
    """Write the names of lines to the right of the axes, none over another.

    Parameters
    ----------
    axis
        With the limits and the scale that it keeps.
    names
    heights
        Where each line ends, as data; names of lines beyond the limits stand at the edge.
    colours
    tall
        The height of the axes in inches.
    """
    up = axis.transScale + axis.transLimits
    places = up.transform([(axis.get_xlim()[0], height) for height in heights])[:, 1]
    desired = np.clip(places, 0.0, 1.0) * tall * _POINTS
    shifted = _apart(desired, _LEADING * SMALL) / (tall * _POINTS)
    for name, place, colour, height in zip(names, shifted, colours, desired, strict=True):
        y = height / (tall * _POINTS)
        axis.text(
            1.02, place, name, transform=axis.transAxes, color=colour, fontsize=SMALL, va="center"
        )
        if abs(place - y) * tall * _POINTS > SMALL / 2:
            axis.annotate(
                "", (1.0, y), xytext=(1.018, place), xycoords="axes fraction",
                textcoords="axes fraction",
                arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.5, "shrinkB": 0},
            )  # fmt: skip


def _apart(desired: NDArray[np.float64], least: float) -> NDArray[np.float64]:
    """Return the places nearest to those desired that are so far apart, in the same order.

    Isotonic regression by pooling adjacent violators (Ayer et al. 1955).
    """
    order = np.argsort(desired, kind="stable")
    pools: list[tuple[float, int]] = []
    for place in desired[order] - least * np.arange(len(desired)):
        mean, count = float(place), 1
        while pools and pools[-1][0] > mean:
            other, several = pools.pop()
            mean = (mean * count + other * several) / (count + several)
            count += several
        pools.append((mean, count))
    means = np.repeat([mean for mean, _ in pools], [count for _, count in pools])
    places = np.empty_like(desired)
    places[order] = means + least * np.arange(len(desired))
    return places
