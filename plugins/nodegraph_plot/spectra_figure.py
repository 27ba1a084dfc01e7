"""How spectra are drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_mocap import figure_text
from nodegraph_tables.axes import SMALL, name_lines, plain
from nodegraph_tables.style import BLACK, QUIET

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_tables.style import Look

    Line = tuple[NDArray[np.float64], NDArray[np.float64]]

_WIDE, _TALL = 6.4, 4.0
_LETTERS = 24
"""In a name beside a line."""


def draw(lines: dict[str, Line], truth: Line | None, look: dict[str, Look]) -> Figure:
    """Return the figure: density by frequency, both without the mean, which was taken off."""
    figure = Figure(figsize=(_WIDE, _TALL))
    axis = figure.add_axes((0.1, 0.12, 0.88, 0.86))
    for name, (frequency, density) in lines.items():
        style = look[name]
        axis.plot(
            frequency[1:],
            density[1:],
            style.line,
            color=style.colour,
            linewidth=1.2,
            label=figure_text(name, across=_LETTERS) or "recording",
        )
    if truth is not None:
        axis.plot(truth[0][1:], truth[1][1:], color=BLACK, linewidth=0.8, label="truth", zorder=5)
    axis.set(yscale="log")
    axis.set_xlabel("frequency (Hz)", fontsize=SMALL, color=QUIET)
    axis.set_ylabel("power (mm\N{SUPERSCRIPT TWO}/Hz)", fontsize=SMALL, color=QUIET)
    axis.margins(x=0.0)
    plain(axis)
    drawn = axis.get_lines()
    name_lines(
        axis,
        [str(line.get_label()) for line in drawn],
        [float(np.asarray(line.get_ydata())[-1]) for line in drawn],
        [str(line.get_color()) for line in drawn],
        _TALL * axis.get_position().height,
    )
    return figure
