"""Which way a mesh faces at its vertices: without it, players show every triangle flat.

Source: glTF 2.0 Specification, section 3.7.2.1 (Meshes Overview): normals are unit vectors.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_AHEAD = np.array([0.0, 0.0, 1.0])


def vertex_normals(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    otherwise: NDArray[np.float64] = _AHEAD,
) -> NDArray[np.float64]:
    """Return (V, 3) unit normals: the mean of those of a vertex's triangles, by their area.

    Vertices at one place keep their own normals, as the lips of a closed mouth must.

    Parameters
    ----------
    vertices
        (V, 3).
    faces
        (F, 3), counter-clockwise as seen from outside.
    otherwise
        What a vertex gets that has no triangle with an area.
    """
    one, two, three = (vertices[faces[:, corner]] for corner in range(3))
    # a cross product is as long as twice the triangle's area
    across = np.repeat(np.cross(two - one, three - one), 3, axis=0)
    corners = faces.ravel()
    sums = np.stack(
        [np.bincount(corners, across[:, axis], len(vertices)) for axis in range(3)], axis=1
    )
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    known = lengths > 0
    return np.where(known, sums / np.where(known, lengths, 1.0), otherwise)
