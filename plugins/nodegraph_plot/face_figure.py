"""Draws faces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D

from nodegraph_mocap import Origin, figure_text
from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.view import frontal
from nodegraph_plot.recordings import true_positions
from nodegraph_tables.style import BLACK, BLUE, GREY, ORANGE

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

RED = "#D5202A"
_ROOM = 0.25
_MARGIN = 0.07
_WIDEST = 11.0
_LEGEND_ENTRY = 1.6
_ACROSS = 24
"""Characters beside a row."""

_ORIGINS = (
    (Origin.MEASURED, "measured", BLUE, "o"),
    (Origin.FILLED, "filled", RED, "o"),
    (Origin.REPAIRED, "repaired", ORANGE, "D"),
)


@dataclass(frozen=True)
class _Face:
    """One recording in one frame, in the picture's millimetres.

    Attributes
    ----------
    points, truth : (M, 2) arrays of float64
    origin : (M,) array of uint8
    edges : (E, 2, 2) array of float64
        Both ends of every edge that has them.
    """

    points: NDArray[np.float64]
    truth: NDArray[np.float64]
    origin: NDArray[np.uint8]
    edges: NDArray[np.float64]

    def of(self, origin: Origin) -> NDArray[np.bool_]:
        """(M,), True for the samples of that origin."""
        return np.asarray(self.origin == origin)

    def known(self, origin: Origin) -> NDArray[np.bool_]:
        """(M,), True for the samples of that origin whose truth is known."""
        return self.of(origin) & np.isfinite(self.truth[:, 0])

    @property
    def steady(self) -> NDArray[np.float64]:
        """Positions that were measured or repaired, and the truth of the rest, (P, 2)."""
        kept = self.of(Origin.MEASURED) | self.of(Origin.REPAIRED)
        known = ~kept & np.isfinite(self.truth[:, 0])
        return np.concatenate([self.points[kept], self.truth[known]])


def draw(
    recordings: dict[str, Trajectories],
    truth: Trajectories | None,
    frames: Sequence[int],
    view: str,
) -> Figure:
    """Return the figure: a row per recording, a column per frame."""
    faces = [_faces(recording, truth, frames, view) for recording in recordings.values()]
    low, high = _limits([face for row in faces for face in row])
    figure, axes = _grid(len(faces), len(frames), high - low)
    for row, name in enumerate(recordings):
        for column, frame in enumerate(frames):
            _panel(axes[row, column], faces[row][column], low, high)
            if row == 0:
                axes[row, column].set_title(f"frame {frame}", fontsize="medium")
        axes[row, 0].set_ylabel(figure_text(name, across=_ACROSS, lines=2))
    _scale_bar(axes[-1, 0], low, high)
    handles = _handles([face for row in faces for face in row])
    across = min(len(handles), int(figure.get_figwidth() / _LEGEND_ENTRY))
    figure.legend(handles=handles, loc="outside lower center", ncols=across, frameon=False)
    return figure


def _faces(
    recording: Trajectories, truth: Trajectories | None, frames: Sequence[int], view: str
) -> list[_Face]:
    seen = frontal(recording, view)
    chosen = list(frames)
    points = seen.project(recording.positions[chosen])
    known = seen.project(true_positions(truth, recording)[chosen])
    ends = np.array(edges_of(recording), dtype=np.intp).reshape(-1, 2)
    return [
        _Face(points[index], known[index], recording.origin[frame], _whole(points[index][ends]))
        for index, frame in enumerate(chosen)
    ]


def _whole(edges: NDArray[np.float64]) -> NDArray[np.float64]:
    return edges[np.isfinite(edges).all(axis=(1, 2))]


def _limits(faces: Sequence[_Face]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the lower left and upper right corner that all pictures share.

    They hold all that was measured and is true; filled samples widen them by a quarter at most.
    """
    everything = np.concatenate([face.points for face in faces] + [face.steady for face in faces])
    everything = everything[np.isfinite(everything[:, 0])]
    steady = np.concatenate([face.steady for face in faces])
    if not len(everything):
        return np.full(2, -1.0), np.full(2, 1.0)
    kept = steady if len(steady) else everything
    size = np.maximum(np.ptp(kept, axis=0), 1.0)
    low = np.maximum(everything.min(axis=0), kept.min(axis=0) - _ROOM * size)
    high = np.minimum(everything.max(axis=0), kept.max(axis=0) + _ROOM * size)
    margin = _MARGIN * size.max()
    return low - margin, high + margin


def _grid(rows: int, columns: int, size: NDArray[np.float64]) -> tuple[Figure, NDArray[np.object_]]:
    height = 2.5 if rows <= 4 else 2.0
    width = height * size[0] / size[1]
    shrink = min(1.0, _WIDEST / (columns * width))
    page = (max(columns * width * shrink + 0.7, 4.8), rows * height * shrink + 1.0)
    layout = ConstrainedLayoutEngine(w_pad=0.02, h_pad=0.02)
    figure = Figure(figsize=page, layout=layout)
    return figure, figure.subplots(rows, columns, squeeze=False)


def _panel(axis: Axes, face: _Face, low: NDArray[np.float64], high: NDArray[np.float64]) -> None:
    axis.add_collection(LineCollection(list(face.edges), colors=GREY, linewidths=0.6, zorder=1))
    for origin, label, colour, marker in _ORIGINS:
        points = face.points[face.of(origin)]
        if len(points):
            axis.scatter(
                points[:, 0],
                points[:, 1],
                s=11,
                c=colour,
                marker=marker,
                linewidths=0,
                label=label,
                zorder=3,
            )
    _draw_truth(axis, face)
    outside = (face.points < low) | (face.points > high)
    count = np.count_nonzero(outside.any(axis=1))
    if count:
        axis.text(0.98, 0.02, f"{count} outside", transform=axis.transAxes, ha="right", color=RED)
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xticks=[], yticks=[])
    axis.set_aspect("equal")
    axis.spines[:].set(color="0.88", linewidth=0.6)


def _draw_truth(axis: Axes, face: _Face) -> None:
    filled, missing = face.known(Origin.FILLED), face.known(Origin.MISSING)
    joined = np.stack([face.points[filled], face.truth[filled]], axis=1)
    axis.add_collection(LineCollection(list(joined), colors=RED, linewidths=0.8, zorder=2))
    for chosen, label, colour in ((filled, "truth", BLACK), (missing, "left missing", GREY)):
        if chosen.any():
            axis.scatter(
                face.truth[chosen, 0],
                face.truth[chosen, 1],
                s=22,
                facecolors="none",
                edgecolors=colour,
                linewidths=0.7,
                label=label,
                zorder=4,
            )


def _scale_bar(axis: Axes, low: NDArray[np.float64], high: NDArray[np.float64]) -> None:
    """Draw a bar of a round length, at most a third of the picture's width."""
    third = (high[0] - low[0]) / 3
    power = 10.0 ** np.floor(np.log10(third))
    length = power * max(step for step in (1, 2, 5) if step * power <= third)
    start = low + 0.04 * (high - low)
    axis.plot([start[0], start[0] + length], [start[1]] * 2, color=BLACK, linewidth=1.5)
    axis.annotate(
        f"{length:g} mm",
        (start[0], start[1]),
        xytext=(0, 3),
        textcoords="offset points",
        fontsize="x-small",
    )


def _handles(faces: Sequence[_Face]) -> list[Artist]:
    """Return a legend of what occurs."""
    shown = {origin for origin in Origin if any(face.of(origin).any() for face in faces)}
    handles: list[Artist] = [
        _symbol(label, colour, marker)
        for origin, label, colour, marker in _ORIGINS
        if origin in shown
    ]
    if any(face.known(Origin.FILLED).any() for face in faces):
        handles.append(_symbol("truth of filled", BLACK, "o", hollow=True))
    if any(face.known(Origin.MISSING).any() for face in faces):
        handles.append(_symbol("left missing (truth)", GREY, "o", hollow=True))
    return handles


def _symbol(label: str, colour: str, marker: str, *, hollow: bool = False) -> Line2D:
    return Line2D(
        [],
        [],
        linestyle="none",
        marker=marker,
        markersize=5 if hollow else 4,
        markerfacecolor="none" if hollow else colour,
        markeredgecolor=colour,
        label=label,
    )
