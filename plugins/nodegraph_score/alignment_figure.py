"""How it is drawn what PCA finds: bars of variance, and what head motion makes of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from nodegraph_mocap import figure_text
from nodegraph_score.alignment_text import named
from nodegraph_tables.style import BLUE, PALE, VERMILLION

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from nodegraph_mocap import Table

_ACROSS = 5
_LETTERS = 24
"""In a line above a panel."""

_WIDTH, _HEIGHT = 2.1, 2.3


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
        axis.set_title(figure_text(named(part, axes), across=_LETTERS, lines=2), fontsize="medium")
    for axis in grid[:, 0]:
        axis.set_ylabel("share of variance")
    for axis in grid[-1]:
        axis.set_xlabel("component")
    handles = [
        Patch(facecolor=VERMILLION, label="head motion"),
        Patch(facecolor=PALE, edgecolor=BLUE, label="face"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _panel(axis: Axes, part: Table) -> None:
    component, share = part["component"].to_numpy(), part["share"].to_numpy()
    # Head and face may work against each other: neither then makes less than nothing of it.
    head = share * np.clip(part["head motion"].to_numpy(), 0.0, 1.0)
    axis.bar(component, share, color=PALE, edgecolor=BLUE, linewidth=0.9)
    axis.bar(component, head, color=VERMILLION)
    axis.set_xticks(component)
    axis.spines[["top", "right"]].set_visible(False)
