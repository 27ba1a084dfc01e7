"""Draws trajectories."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from nodegraph_mocap import figure_text
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_plot.recordings import estimated, true_positions
from nodegraph_tables.axes import SMALL, plain
from nodegraph_tables.style import BLACK, LIGHT, PALE, REST, Look

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

_STRAY = 1.5
_BROAD = 3.0
_LETTERS = 22
"""Letters in the name of a line."""

_TALL = 1.7
"""Inches of a panel."""

_LEADING = 1.3 * SMALL / 72.0
"""Inches between the names of two lines."""


@dataclass(frozen=True)
class _Curves:
    """One marker in the frames drawn, in R recordings of F frames.

    Attributes
    ----------
    frames : (F,) array of int
    positions : (R, F, 3) array of float64
    truth : (F, 3) array of float64
    estimated, measured : (R, F) arrays of bool
    """

    frames: NDArray[np.intp]
    positions: NDArray[np.float64]
    truth: NDArray[np.float64]
    estimated: NDArray[np.bool_]
    measured: NDArray[np.bool_]

    @property
    def common(self) -> NDArray[np.bool_]:
        """(F,), True where all recordings have the same measured sample."""
        equal = (self.positions == self.positions[0]).all(axis=2)
        return np.asarray((equal & self.measured).all(axis=0))

    @property
    def own(self) -> NDArray[np.bool_]:
        """(F,), True where recordings differ, and at the common samples beside."""
        apart = np.pad(~self.common, 1)
        return np.asarray(apart[:-2] | apart[1:-1] | apart[2:])

    @property
    def gaps(self) -> NDArray[np.bool_]:
        """(F,), True where some recording has no measured sample, or a repaired one."""
        return np.asarray((self.estimated | ~self.measured).any(axis=0))

    @property
    def shading(self) -> set[str]:
        """Meanings of the shaded frames: ``gap`` where no sample was measured, ``repaired``."""
        flagged = {"gap": ~self.measured, "repaired": self.estimated & self.measured}
        return {name for name, flags in flagged.items() if flags.any()}


def draw(
    recordings: dict[str, Trajectories],
    truth: Trajectories | None,
    look: dict[str, Look],
    markers: Sequence[str],
    window: tuple[int, int],
    coordinates: Sequence[str],
) -> Figure:
    """Return the figure: a row per coordinate, a column per marker.

    Recordings that have a look are drawn in full, the others thin and grey.
    """
    rows, columns = len(coordinates), len(markers)
    figure = Figure(figsize=(max(4.6 * columns, 7.0), _TALL * rows + 0.8), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, squeeze=False)
    rate = next(iter(recordings.values())).rate
    shading: set[str] = set()
    for column, marker in enumerate(markers):
        curves = _curves(recordings, truth, marker, window)
        shading |= curves.shading
        for row, coordinate in enumerate(coordinates):
            _panel(axes[row, column], curves, "xyz".index(coordinate), look, list(recordings))
        axes[0, column].set_title(figure_text(marker))
        axes[-1, column].set_xlabel(f"frame (at {rate:g} Hz)")
    for row, coordinate in enumerate(coordinates):
        axes[row, 0].set_ylabel(f"{coordinate} (mm)")
    handles = _handles(len(recordings) - len(look), sorted(shading))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=len(handles),
        frameon=False,
        fontsize="small",
    )
    return figure


def _curves(
    recordings: dict[str, Trajectories],
    truth: Trajectories | None,
    marker: str,
    window: tuple[int, int],
) -> _Curves:
    part = slice(window[0], window[1] + 1)
    places = [(recording, recording.markers.index(marker)) for recording in recordings.values()]
    first, column = places[0]
    return _Curves(
        frames=np.arange(window[0], window[1] + 1),
        positions=np.stack([recording.positions[part, place] for recording, place in places]),
        truth=true_positions(truth, first)[part, column],
        estimated=np.stack([estimated(recording)[part, place] for recording, place in places]),
        measured=np.stack([recording.measured[part, place] for recording, place in places]),
    )


def _panel(
    axis: Axes, curves: _Curves, coordinate: int, look: dict[str, Look], names: Sequence[str]
) -> None:
    values = curves.positions[..., coordinate]
    true = curves.truth[..., coordinate]
    _, starts, stops = runs_of(curves.gaps)
    for first, last in zip(curves.frames[starts], curves.frames[stops - 1], strict=True):
        axis.axvspan(first - 0.5, last + 0.5, color=PALE, linewidth=0, zorder=0)
    common = np.where(curves.common, values[0], np.nan)
    (grey,) = axis.plot(curves.frames, common, color=LIGHT, linewidth=_BROAD, label="measured")
    named: list[tuple[str, Look, NDArray[np.float64]]] = []
    for place, name in enumerate(names):
        if name in look:
            _line(axis, curves, place, values[place], look[name], name)
            named.append((name or "recording", look[name], values[place]))
        else:
            own = np.where(curves.own, values[place], np.nan)
            axis.plot(curves.frames, own, color=REST, linewidth=0.5, label=name, zorder=2.5)
    (black,) = axis.plot(curves.frames, true, color=BLACK, linewidth=0.8, label="truth")
    grey.set(zorder=2, **_dots(common))
    black.set(zorder=5, **_dots(true))
    if np.isfinite(true).any():
        named.append(("truth", Look(BLACK, "", "-"), true))
    _limit(axis, np.concatenate([values[curves.measured], true]), values)
    _along(axis, curves.frames)
    plain(axis)
    _name(axis, named)


def _name(axis: Axes, lines: Sequence[tuple[str, Look, NDArray[np.float64]]]) -> None:
    """Write the names of lines beside the axes, in their order where they are farthest apart."""
    every = np.array([values for _, _, values in lines])
    known = np.isfinite(every)
    apart = np.where(known, every, -np.inf).max(axis=0) - np.where(known, every, np.inf).min(axis=0)
    widest = int(np.argmax(np.where(known.any(axis=0), apart, -1.0)))
    # what is missing there comes last
    order = np.argsort(np.nan_to_num(every[:, widest], nan=-np.inf), kind="stable")
    middle = (len(lines) - 1) / 2
    for step, place in enumerate(order):
        name, look, _ = lines[place]
        height = 0.5 + (step - middle) * _LEADING / _TALL
        axis.plot(
            [1.02, 1.07], [height, height], look.line, color=look.colour, linewidth=1.4,
            marker=look.marker, markersize=3, markevery=[0], transform=axis.transAxes,
            clip_on=False,
        )  # fmt: skip
        axis.text(
            1.09, height, figure_text(name, across=_LETTERS), transform=axis.transAxes,
            color=look.colour, fontsize=SMALL, va="center",
        )  # fmt: skip


def _line(
    axis: Axes,
    curves: _Curves,
    place: int,
    values: NDArray[np.float64],
    look: Look,
    name: str,
) -> None:
    own = np.where(curves.own, values, np.nan)
    (line,) = axis.plot(curves.frames, own, look.line, color=look.colour, linewidth=1.1, label=name)
    line.set(zorder=3, **_dots(own))
    filled = curves.estimated[place]
    axis.plot(
        curves.frames[filled],
        values[filled],
        look.marker,
        color=look.colour,
        markersize=2.6,
        markeredgewidth=0,
        label=f"{name}, filled",
        zorder=4,
    )


def _dots(values: NDArray[np.float64]) -> dict[str, object]:
    """Return the dots of a line, on samples without a neighbour: a line does not show them."""
    known = np.pad(np.isfinite(values), 1)
    alone = known[1:-1] & ~known[:-2] & ~known[2:]
    return {"marker": "." if alone.any() else "", "markevery": np.flatnonzero(alone).tolist()}


def _along(axis: Axes, frames: NDArray[np.intp]) -> None:
    """Show the frames and no parts of any; one alone has some room on both sides."""
    axis.margins(x=0.01)
    if len(frames) == 1:
        axis.set(xlim=(frames[0] - 1, frames[0] + 1), xticks=frames)
    else:
        axis.locator_params(axis="x", integer=True)


def _limit(axis: Axes, steady: NDArray[np.float64], values: NDArray[np.float64]) -> None:
    """Keep what strays far from the measured samples and the truth from flattening the rest."""
    steady, values = steady[np.isfinite(steady)], values[np.isfinite(values)]
    if not len(steady) or np.ptp(steady) == 0:
        return
    everything = np.concatenate([steady, values])
    room = _STRAY * np.ptp(steady)
    low = max(everything.min(), steady.min() - room)
    high = min(everything.max(), steady.max() + room)
    margin = 0.06 * (high - low)
    axis.set_ylim(low - margin, high + margin)


def _handles(others: int, shading: Sequence[str]) -> list[Artist]:
    """Return the lines that have no name next to them."""
    handles: list[Artist] = [Line2D([], [], color=LIGHT, linewidth=_BROAD, label="measured in all")]
    if others:
        label = f"{others} others" if others > 1 else "another"
        handles.append(Line2D([], [], color=REST, linewidth=0.7, label=label))
    if shading:
        handles.append(Patch(color=PALE, label=" or ".join(shading)))
    return handles
