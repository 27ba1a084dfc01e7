"""How errors are drawn on a face."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from nodegraph_mocap import figure_text
from nodegraph_mocap.view import frontal
from nodegraph_tables.style import GREY

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

_ACROSS = 4
_LETTERS = 30
"""In a line above a picture."""

_COLOURS = "cividis_r"
_LONGEST = 3.0
"""How many times the median edge a triangle's edge may be long; longer ones bridge the outside."""


def draw(
    recordings: dict[str, Trajectories],
    errors: dict[str, NDArray[np.float64]],
    truth: Trajectories,
    view: str,
) -> Figure:
    """Return the figure: a picture per recording, and the scale."""
    columns = min(len(recordings), _ACROSS)
    rows = math.ceil(len(recordings) / columns)
    figure = Figure(figsize=(2.6 * columns + 1.0, 2.9 * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    largest = max(
        float(np.nanmax(values)) for values in errors.values() if np.isfinite(values).any()
    )
    seen = frontal(truth, view)
    places = dict(zip(truth.markers, seen.project(_mean(truth)), strict=True))
    drawn: ScalarMappable | None = None
    for axis, (name, recording) in zip(axes.flat, recordings.items(), strict=False):
        known = np.array([places.get(marker, (np.nan, np.nan)) for marker in recording.markers])
        drawn = _picture(axis, known, errors[name], largest) or drawn
        title = f"{figure_text(name, across=_LETTERS, lines=2)}\n{_overall(errors[name])}"
        axis.set_title(title.lstrip("\n"), fontsize="medium")
    for axis in axes.flat[len(recordings) :]:
        axis.set_visible(False)
    if drawn is not None:
        figure.colorbar(drawn, ax=axes, label="error (mm, root mean square)", shrink=0.7)
    return figure


def _mean(truth: Trajectories) -> NDArray[np.float64]:
    count = truth.present.sum(axis=0)
    total = np.where(truth.present[..., np.newaxis], truth.positions, 0.0).sum(axis=0)
    return np.where(count[:, np.newaxis] > 0, total / np.maximum(count, 1)[:, np.newaxis], np.nan)


def _overall(errors: NDArray[np.float64]) -> str:
    known = errors[np.isfinite(errors)]
    return f"median of markers {np.median(known):.2g} mm" if len(known) else "no sample"


def _picture(
    axis: Axes, points: NDArray[np.float64], errors: NDArray[np.float64], largest: float
) -> ScalarMappable | None:
    there = np.isfinite(points[:, 0])
    known = there & np.isfinite(errors)
    without = points[there & ~known]
    axis.scatter(
        without[:, 0],
        without[:, 1],
        s=18,
        facecolors="none",
        edgecolors=GREY,
        linewidths=0.7,
        label="no sample",
    )
    _shade(axis, points[known], errors[known], largest)
    axis.set(aspect="equal", xticks=[], yticks=[])
    axis.spines[:].set(color="0.88", linewidth=0.6)
    if not known.any():
        return None
    return axis.scatter(
        points[known, 0],
        points[known, 1],
        s=26,
        c=errors[known],
        cmap=_COLOURS,
        vmin=0.0,
        vmax=largest,
        linewidths=0.4,
        edgecolors="white",
        label="error",
        zorder=3,
    )


def _shade(
    axis: Axes, points: NDArray[np.float64], errors: NDArray[np.float64], largest: float
) -> None:
    """Colour the triangles between neighbouring markers, if there are any."""
    from matplotlib.tri import Triangulation

    try:
        mesh = Triangulation(points[:, 0], points[:, 1])
    except (RuntimeError, ValueError):
        return  # fewer than three markers, or all on a line
    corners = mesh.triangles
    lengths = np.linalg.norm(points[corners] - points[np.roll(corners, 1, axis=1)], axis=2)
    mesh.set_mask(lengths.max(axis=1) > _LONGEST * np.median(lengths))
    axis.tripcolor(
        mesh,
        facecolors=errors[corners].mean(axis=1),
        cmap=_COLOURS,
        vmin=0.0,
        vmax=largest,
        alpha=0.55,
        linewidth=0,
        zorder=1,
    )
