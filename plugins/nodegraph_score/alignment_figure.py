"""Draws the variances of principal components, and the share of head motion in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from nodegraph_mocap import figure_text
from nodegraph_score.alignment_answer import named
from nodegraph_tables.axes import SMALL, plain
from nodegraph_tables.style import LINE, QUIET, REST, STANDS_OUT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from nodegraph_mocap import Table

_ACROSS = 5
_LETTERS = 24
"""Letters in a line above a panel."""

_LEAST = 0.005
"""The smallest share of a component that is written."""

_WIDTH, _HEIGHT = 2.1, 1.9


def draw(table: Table, axes: tuple[str, ...]) -> Figure:
    """Return the figure: a panel per recording, a bar per component."""
    # Each recording has a component of rank 1, and its rows follow one another.
    recording = table["component"].eq(1).cumsum()
    panels = [part for _, part in table.groupby(recording)]
    rows = -(-len(panels) // _ACROSS)
    columns = -(-len(panels) // rows)
    size = (max(_WIDTH * columns, 4.0) + 0.5, _HEIGHT * rows + 0.6)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for axis in grid.ravel()[len(panels) :]:
        axis.set_axis_off()
    for axis, part in zip(grid.ravel(), panels, strict=False):
        _panel(axis, part)
        axis.set_title(
            figure_text(named(part, axes), across=_LETTERS, lines=2), fontsize=SMALL + 1, loc="left"
        )
    figure.supxlabel(
        "Share of the variance of each principal component. Filled: what head motion makes of it.",
        x=0.01, ha="left", fontsize=SMALL, color=QUIET,
    )  # fmt: skip
    return figure


def _panel(axis: Axes, part: Table) -> None:
    component, share = part["component"].to_numpy(), part["share"].to_numpy()
    # Head and face may work against each other: neither then makes less than nothing of it.
    head = share * np.clip(part["head motion"].to_numpy(), 0.0, 1.0)
    plain(axis)
    axis.bar(component, share, color=LINE, edgecolor=REST, linewidth=0.9)
    axis.bar(component, head, color=STANDS_OUT)
    for place, whole, part in zip(component, share, head, strict=True):
        if part > _LEAST * whole:
            axis.annotate(
                f"{100 * part / whole:.0f} % head", (place, whole), xytext=(0, 3),
                textcoords="offset points", ha="center", fontsize=SMALL - 1, color=STANDS_OUT,
            )  # fmt: skip
    axis.margins(y=0.15)
    axis.set_xticks(component)
    axis.yaxis.set_major_formatter(PercentFormatter(1.0, decimals=0, symbol=" %"))
