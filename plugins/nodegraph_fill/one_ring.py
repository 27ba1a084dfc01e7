"""Which markers are joined when a face is triangulated as seen from the front."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories


def one_ring(recording: Trajectories) -> NDArray[np.bool_]:
    """Return which markers a Delaunay triangulation of the face joins.

    The markers' reference shape is projected on the plane of its first two principal axes: a
    face is wider and higher than it is deep, so that this is the view from the front.

    Returns
    -------
    (M, M) array of bool
        Symmetric, False on the diagonal. A marker that lies where another one does shares its
        ring and is in it. Where no triangle can be made (fewer than three places, or all on a
        line), every marker is joined to every other. A marker that is never present to none.
    """
    shape = reference_shape(recording)
    known = np.flatnonzero(~np.isnan(shape[:, 0]))
    joined = np.zeros((len(shape), len(shape)), dtype=np.bool_)
    joined[np.ix_(known, known)] = _triangulated(_from_the_front(shape[known]))
    np.fill_diagonal(joined, False)
    return joined


def _from_the_front(points: NDArray[np.float64]) -> NDArray[np.float64]:
    if not len(points):
        return np.zeros((0, 2))
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    return np.asarray(centred @ axes[:2].T)


def _triangulated(plane: NDArray[np.float64]) -> NDArray[np.bool_]:
    from scipy.spatial import Delaunay, QhullError

    try:
        mesh = Delaunay(plane)
    except (QhullError, ValueError):
        return np.ones((len(plane), len(plane)), dtype=np.bool_)
    joined = np.eye(len(plane), dtype=np.bool_)
    joined[mesh.simplices[:, :, None], mesh.simplices[:, None, :]] = True
    for point, _, nearest in mesh.coplanar:
        joined[point] |= joined[nearest]
        joined[:, point] |= joined[:, nearest]
    return joined
