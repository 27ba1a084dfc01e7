"""Edges between markers, by which a face is drawn."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import MarkerSet

_LONGEST_EDGE = 2.5
"""Times the median length: longer lines only span the hollows of the outline."""


def edges_between(marker_set: MarkerSet, points: NDArray[np.float64]) -> MarkerSet:
    """Return the marker set with lines to draw: its frontal projection, triangulated.

    Parameters
    ----------
    marker_set
    points
        (M, 3) mm; z is left out.
    """
    from scipy.spatial import Delaunay

    triangles = Delaunay(points[:, :2]).simplices
    lines = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, ::2]]))
    lines = np.unique(lines, axis=0)
    lengths = np.linalg.norm(points[lines[:, 0], :2] - points[lines[:, 1], :2], axis=1)
    lines = lines[lengths <= _LONGEST_EDGE * np.median(lengths)]
    # A line without its mirror is one of two equally good diagonals, taken by rounding.
    mirror = _mirror(marker_set)
    known = {(int(first), int(second)) for first, second in lines}
    symmetric = [line for line in sorted(known) if _mirrored(line, mirror) in known]
    names = marker_set.markers
    return replace(
        marker_set, edges=tuple((names[first], names[second]) for first, second in symmetric)
    )


def _mirror(marker_set: MarkerSet) -> list[int]:
    other = {left: right for left, right in marker_set.pairs}
    other |= {right: left for left, right in marker_set.pairs}
    return [marker_set.markers.index(other.get(name, name)) for name in marker_set.markers]


def _mirrored(line: tuple[int, int], mirror: list[int]) -> tuple[int, int]:
    first, second = sorted(mirror[end] for end in line)
    return first, second
