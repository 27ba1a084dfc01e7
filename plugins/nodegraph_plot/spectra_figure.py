"""How spectra are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from nodegraph_mocap import figure_text
from nodegraph_tables.style import BLACK

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from nodegraph_tables.style import Look

    Line = tuple[NDArray[np.float64], NDArray[np.float64]]

_LETTERS = 24
"""In a line of the legend."""


def draw(lines: dict[str, Line], truth: Line | None, look: dict[str, Look]) -> Figure:
    """Return the figure: density by frequency, both without the mean, which was taken off."""
    figure = Figure(figsize=(7.0, 4.0), layout="constrained")
    axis = figure.subplots()
    for name, (frequency, density) in lines.items():
        style = look[name]
        axis.plot(
            frequency[1:],
            density[1:],
            style.line,
            color=style.colour,
            marker=style.marker,
            markevery=0.12,
            markersize=4,
            linewidth=1.2,
            label=figure_text(name, across=_LETTERS, lines=2) or "recording",
        )
    if truth is not None:
        axis.plot(truth[0][1:], truth[1][1:], color=BLACK, linewidth=0.8, label="truth", zorder=5)
    axis.set(xlabel="frequency (Hz)", ylabel="power (mm\N{SUPERSCRIPT TWO}/Hz)", yscale="log")
    axis.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside right upper", frameon=False)
    return figure
