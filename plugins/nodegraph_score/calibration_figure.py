"""How a calibration is drawn: shares of errors within intervals against the intervals' levels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from nodegraph_tables.axes import SMALL, name_lines, plain
from nodegraph_tables.style import BEST, QUIET, REST

if TYPE_CHECKING:
    from nodegraph_mocap import Table

_SIDE = 3.6


def draw(table: Table, levels: Mapping[str, float]) -> Figure:
    """Return the figure: a line per row of the table, the last of all gaps, and the diagonal."""
    figure = Figure(figsize=(_SIDE, _SIDE))
    axis = figure.add_axes((0.14, 0.13, 0.84, 0.84))
    axis.set(xlim=(0.4, max(levels.values())), ylim=(0.0, 1.0))
    axis.plot([0.0, 1.0], [0.0, 1.0], color=REST, linewidth=0.9, linestyle=":")
    *_, whole = table["frames"]
    names, ends, colours = ["as stated"], [max(levels.values())], [REST]
    for _, row in table.iterrows():
        name = row["frames"]
        colour = BEST if name == whole else REST
        shares = [row[level] for level in levels]
        label = "all gaps" if name == whole else f"{name} frames"
        axis.plot(list(levels.values()), shares, ".-", color=colour, label=label, clip_on=False)
        if math.isfinite(shares[-1]):
            names.append(label)
            ends.append(shares[-1])
            colours.append(colour)
    axis.text(0.42, 0.97, "conservative", fontsize=SMALL, color=QUIET, va="top")
    axis.text(axis.get_xlim()[1] - 0.02, 0.4, "too narrow", fontsize=SMALL, color=QUIET, ha="right")
    axis.set_xlabel("level of the normal interval", fontsize=SMALL, color=QUIET)
    axis.set_ylabel("share of errors within it", fontsize=SMALL, color=QUIET)
    plain(axis, grid="both")
    name_lines(axis, names, ends, colours, _SIDE * axis.get_position().height)
    return figure
