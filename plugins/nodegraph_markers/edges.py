"""Lines between markers, to draw a face by."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WIDEST = 2.5
"""Times the median circumradius: larger triangles only span the hollows of the outline."""


def edges_of(plane: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Return which points the triangles of a Delaunay triangulation join.

    Triangles whose circumcircle is more than 2.5 times as wide as the median one are left out:
    long ones across the hollows of the outline, and thin ones along it.

    Parameters
    ----------
    plane
        (N, 2) mm, the markers as seen from the front, not all on a line.

    Returns
    -------
    list of (int, int)
        The lower number first, in rising order.
    """
    from scipy.spatial import Delaunay

    triangles = Delaunay(plane).simplices
    radius = _circumradius(plane[triangles])
    compact = triangles[radius <= _WIDEST * np.median(radius)]
    sides = np.sort(np.concatenate([compact[:, [0, 1]], compact[:, [1, 2]], compact[:, [0, 2]]]))
    return [(first, second) for first, second in np.unique(sides, axis=0).tolist()]


def _circumradius(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``a b c / (4 area)`` of triangles, (F, 3, 2)."""
    sides = corners - np.roll(corners, 1, axis=1)
    lengths = np.linalg.norm(sides, axis=2).prod(axis=1)
    twice = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    return np.asarray(lengths / np.maximum(2.0 * twice, np.finfo(float).tiny))
