"""Draws selected markers."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from nodegraph_mocap import figure_text
from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.view import frontal
from nodegraph_tables.style import BLACK, GREY, LIGHT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph_mocap import Selection, Trajectories

_COLUMNS = 4
_LETTERS = 30
"""Letters in a line above a face."""

_SHARE = "share of the runs that chose the pair"
_MAP = colormaps["viridis_r"]
_SCALE = Normalize(0.0, 1.0)
_FULL, _HOLLOW = 46.0, 30.0
_MARGIN = 0.06


@dataclass(frozen=True)
class Panel:
    """A selection, what it is called, and the face that it is drawn on."""

    name: str
    selection: Selection
    recording: Trajectories

    @property
    def title(self) -> str:
        """The name, and how many of the recording's markers are chosen."""
        chosen, markers = len(self.selection.chosen), len(self.recording.markers)
        share = f"{chosen} of {markers} markers ({100 * chosen / markers:.0f} %)"
        name = figure_text(self.name, across=_LETTERS, lines=2)
        return f"{name}\n{share}" if name else share

    def shares(self) -> NDArray[np.float64]:
        """Return the frequency of each of the recording's markers, NaN where it is not known."""
        known: dict[str, float] = {}
        if self.selection.frequencies is not None:
            both = zip(self.selection.pairs, self.selection.frequencies.tolist(), strict=True)
            known = {marker: share for pair, share in both for marker in pair}
        return np.array([known.get(marker, np.nan) for marker in self.recording.markers])


def draw(panels: Sequence[Panel], view: str) -> Figure:
    """Return the figure: a face per panel, all of one scale where they fit into it."""
    columns = min(len(panels), _COLUMNS)
    rows = math.ceil(len(panels) / columns)
    figure = Figure(figsize=(max(2.7 * columns + 0.9, 4.2), 3.2 * rows + 0.5), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    places = [_places(panel.recording, view) for panel in panels]
    for axis, panel, points in zip(axes, panels, places, strict=False):
        _draw_face(axis, panel, points)
    _equal_limits(axes, places)
    for axis in axes[len(panels) :]:
        axis.remove()
    if any(np.isfinite(panel.shares()).any() for panel in panels):
        bar = ScalarMappable(_SCALE, _MAP)
        figure.colorbar(bar, ax=axes[: len(panels)].tolist(), label=_SHARE, shrink=0.8)
    names = ("chosen", "not chosen")
    handles = [_symbol(BLACK, BLACK), _symbol("none", BLACK)]
    figure.legend(handles, names, loc="outside lower center", ncols=2, frameon=False)
    return figure


def _places(recording: Trajectories, view: str) -> NDArray[np.float64]:
    """Return the mean place of each marker in the picture, (M, 2); NaN where it has no sample."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Mean of empty slice", RuntimeWarning)
        mean = np.nanmean(recording.positions, axis=0)
    return frontal(recording, view).project(mean)


def _draw_face(axis: Axes, panel: Panel, points: NDArray[np.float64]) -> None:
    recording = panel.recording
    ends = points[np.array(edges_of(recording), dtype=np.intp).reshape(-1, 2)]
    ends = ends[np.isfinite(ends).all(axis=(1, 2))]
    axis.add_collection(LineCollection(list(ends), colors=LIGHT, linewidths=0.6, zorder=1))
    chosen = np.isin(recording.markers, panel.selection.chosen)
    colours = _colours(panel.shares())
    _draw_markers(axis, points[chosen], colours[chosen], "chosen")
    _draw_markers(axis, points[~chosen], colours[~chosen], "not chosen")
    axis.set(xticks=[], yticks=[])
    axis.set_title(panel.title, fontsize="medium")
    axis.set_aspect("equal")
    axis.spines[:].set_visible(False)


def _draw_markers(
    axis: Axes, points: NDArray[np.float64], colours: NDArray[np.float64], label: str
) -> None:
    full = label == "chosen"
    drawn = axis.scatter(
        points[:, 0], points[:, 1], s=_FULL if full else _HOLLOW, label=label, zorder=3
    )
    rows = [tuple(row) for row in colours.tolist()]
    drawn.set_facecolor(rows if full else "none")
    drawn.set_edgecolor(BLACK if full else rows)
    drawn.set_linewidth(0.6 if full else 1.4)


def _colours(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colours of shares, (M, 4); grey where there is none."""
    colours = _MAP(_SCALE(np.nan_to_num(shares)))
    colours[~np.isfinite(shares)] = to_rgba(GREY)
    return np.asarray(colours, dtype=np.float64)


def _equal_limits(axes: NDArray[np.object_], places: Sequence[NDArray[np.float64]]) -> None:
    """Give all faces one scale, each in the middle of its picture."""
    known = [points[np.isfinite(points[:, 0])] for points in places]
    known = [points if len(points) else np.zeros((1, 2)) for points in known]
    half = max(float(np.ptp(points, axis=0).max()) for points in known) / 2 or 1.0
    half *= 1 + 2 * _MARGIN
    for axis, points in zip(axes, known, strict=False):
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        axis.set(
            xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half)
        )


def _symbol(face: str, edge: str) -> Line2D:
    return Line2D(
        [], [], linestyle="none", marker="o", markersize=6, markerfacecolor=face,
        markeredgecolor=edge,
    )  # fmt: skip
