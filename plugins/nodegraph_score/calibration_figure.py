"""How a calibration is drawn: shares of errors within intervals against the intervals' levels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from nodegraph_tables.style import BLACK, GREY, looks

if TYPE_CHECKING:
    from nodegraph_mocap import Table


def draw(table: Table, levels: Mapping[str, float]) -> Figure:
    """Return the figure: a line per row of the table, the last of all gaps, and the diagonal."""
    figure = Figure(figsize=(4.2, 3.2), layout="constrained")
    axis = figure.subplots()
    axis.plot([0.0, 1.0], [0.0, 1.0], color=GREY, linewidth=0.9)
    *lengths, whole = table["frames"]
    look = looks(lengths)
    for _, row in table.iterrows():
        name = row["frames"]
        colour, marker = (BLACK, ".") if name == whole else (look[name].colour, look[name].marker)
        shares = [row[level] for level in levels]
        label = "all gaps" if name == whole else f"{name} frames"
        axis.plot(list(levels.values()), shares, color=colour, marker=marker, label=label)
    axis.set(xlim=(0.4, 1.0), ylim=(0.0, 1.0))
    axis.set_xlabel("level of the interval")
    axis.set_ylabel("share of errors within it")
    axis.spines[["top", "right"]].set_visible(False)
    axis.legend(frameon=False)
    return figure
