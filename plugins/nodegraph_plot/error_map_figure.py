"""Draws errors on a face."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, LogNorm, to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from nodegraph_mocap import figure_text
from nodegraph_mocap.face_layout import edges_of
from nodegraph_mocap.view import frontal
from nodegraph_tables.axes import SMALL
from nodegraph_tables.style import LINE, QUIET, REST

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

_ACROSS = 5
_LETTERS = 22
"""Letters in a line above a picture."""

_COLOURS = LinearSegmentedColormap.from_list("errors", ["#f6e3bd", "#d9791c", "#7a2b08"])
_SMALLEST, _LARGEST = 10.0, 110.0
"""Areas of discs in square points."""

_STEPS = 4
"""Discs in the legend."""

Points = dict[str, "NDArray[np.float64]"]


class _Scale:
    """Errors as areas and colours of discs, both logarithmic."""

    def __init__(self, errors: NDArray[np.float64]) -> None:
        positive = errors[errors > 0]
        high = float(positive.max()) if len(positive) else 1.0
        low = float(positive.min()) if len(positive) else high
        # a scale needs two ends
        self.norm = LogNorm(low if low < high else high / 2, high, clip=True)

    def areas(self, errors: NDArray[np.float64]) -> NDArray[np.float64]:
        lowest = float(self.norm.vmin or 0.0)
        shares = np.asarray(self.norm(np.maximum(errors, lowest)))
        return np.asarray(_SMALLEST + (_LARGEST - _SMALLEST) * shares)

    def steps(self) -> list[float]:
        """Return the errors of the legend, to two digits."""
        ends = float(self.norm.vmin or 0.0), float(self.norm.vmax or 0.0)
        return [float(f"{error:.2g}") for error in np.geomspace(*ends, _STEPS)]


@dataclass(frozen=True)
class MarkerErrors:
    """The errors of one picture, by marker.

    Attributes
    ----------
    errors : dict of marker to float
        Millimetres; NaN without a sample.
    samples : dict of marker to int
        How many are behind each error.
    takes : int
    """

    errors: dict[str, float]
    samples: dict[str, int]
    takes: int


def draw(pictures: Mapping[str, MarkerErrors], truths: Sequence[Trajectories], view: str) -> Figure:
    """Return the figure: a picture per method, one of the numbers of samples, and the scale."""
    count = len(pictures) + 1
    columns = min(count, _ACROSS)
    rows = math.ceil(count / columns)
    figure = Figure(figsize=(2.0 * columns, 2.5 * rows + 0.4), layout="constrained")
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    points = _points(truths, view)
    edges = _edges(truths[0], points)
    every = np.concatenate([list(picture.errors.values()) for picture in pictures.values()])
    scale = _Scale(every[np.isfinite(every)])
    for axis in axes:
        axis.set(aspect="equal", xticks=[], yticks=[])
        axis.spines[:].set_visible(False)
    for axis, (name, picture) in zip(axes, pictures.items(), strict=False):
        _face(axis, points, edges)
        _discs(axis, points, picture, scale)
        title = f"{figure_text(name, across=_LETTERS, lines=2)}\n{_overall(picture)}"
        axis.set_title(title.lstrip("\n"), fontsize=SMALL)
    numbers = axes[len(pictures)]
    _face(numbers, points, edges)
    _numbers(numbers, points, pictures)
    for axis in axes[count:]:
        axis.set_visible(False)
    figure.legend(
        handles=_handles(
            scale, hollow=any(0 in each.samples.values() for each in pictures.values())
        ),
        loc="outside lower center",
        ncols=_STEPS + 1,
        frameon=False,
        fontsize="small",
    )
    return figure


def _points(truths: Sequence[Trajectories], view: str) -> Points:
    """Return where the markers are on the mean face, each truth's seen from its own front."""
    places: dict[str, list[NDArray[np.float64]]] = {}
    for truth in truths:
        seen = frontal(truth, view).project(truth.positions)
        for column in np.flatnonzero(truth.present.any(axis=0)):
            middle = np.nanmean(seen[:, column], axis=0)
            places.setdefault(truth.markers[column], []).append(middle)
    return {marker: np.mean(each, axis=0) for marker, each in places.items()}


def _edges(truth: Trajectories, points: Points) -> NDArray[np.float64]:
    """Return the edges as one line, (3 E, 2), broken by NaN between them."""
    names = ((truth.markers[first], truth.markers[second]) for first, second in edges_of(truth))
    gap = np.full(2, np.nan)
    ends = [[points[a], points[b], gap] for a, b in names if a in points and b in points]
    return np.array(ends).reshape(-1, 2)


def _face(axis: Axes, points: Points, edges: NDArray[np.float64]) -> None:
    axis.plot(edges[:, 0], edges[:, 1], color=LINE, linewidth=0.5, zorder=1)
    every = np.array(list(points.values()))
    low, high = every.min(axis=0), every.max(axis=0)
    room = 0.08 * max(1.0, float((high - low).max()))
    axis.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))


def _overall(picture: MarkerErrors) -> str:
    known = [error for error in picture.errors.values() if np.isfinite(error)]
    takes = f", {picture.takes} takes" if picture.takes > 1 else ""
    return f"median {np.median(known):.2g} mm{takes}" if known else "no sample"


def _discs(axis: Axes, points: Points, picture: MarkerErrors, scale: _Scale) -> None:
    there = [marker for marker in picture.errors if marker in points]
    errors = np.array([picture.errors[marker] for marker in there])
    places = np.array([points[marker] for marker in there]).reshape(-1, 2)
    known = np.isfinite(errors)
    axis.scatter(
        places[~known, 0], places[~known, 1], s=18, facecolors="none", edgecolors=REST,
        linewidths=0.7, label="no sample", zorder=2,
    )  # fmt: skip
    axis.scatter(
        places[known, 0], places[known, 1], s=scale.areas(errors[known]), c=errors[known],
        cmap=_COLOURS, norm=scale.norm, edgecolors=REST, linewidths=0.4, label="error", zorder=3,
    )  # fmt: skip


def _numbers(axis: Axes, points: Points, pictures: Mapping[str, MarkerErrors]) -> None:
    least: dict[str, int] = {}
    for picture in pictures.values():
        for marker, number in picture.samples.items():
            least[marker] = min(number, least.get(marker, number))
    for marker, number in least.items():
        if marker in points:
            x, y = points[marker].tolist()
            axis.text(x, y, str(number), fontsize=5, ha="center", va="center", color=QUIET)
    alike = all(each.samples == least for each in pictures.values())
    axis.set_title(f"samples behind\neach error{'' if alike else ', at least'}", fontsize=SMALL)


def _handles(scale: _Scale, *, hollow: bool) -> list[Line2D]:
    steps = scale.steps()
    handles = [
        _disc(
            f"{error:g}{' mm' if error == steps[-1] else ''}",
            area,
            to_hex(_COLOURS(float(scale.norm(error)))),
        )
        for error, area in zip(steps, scale.areas(np.array(steps)), strict=True)
    ]
    return [*handles, *([_disc("no sample", 18.0, "none")] if hollow else [])]


def _disc(label: str, area: float, colour: str) -> Line2D:
    return Line2D(
        [], [], linestyle="none", marker="o", markersize=math.sqrt(area), label=label,
        markerfacecolor=colour, markeredgecolor=REST, markeredgewidth=0.5,
    )  # fmt: skip
