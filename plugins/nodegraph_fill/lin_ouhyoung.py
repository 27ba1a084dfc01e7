"""Displacements of many neighbours, weighted by a cosine of their distance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from nodegraph_fill.stepwise import Rule, lookahead, stepwise
from nodegraph_fill.tuning import Tune
from nodegraph_mocap import Trajectories
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray


Neighbours = Annotated[
    Annotated[int, Field(ge=1)] | Literal["one_ring"], Tune(4, 6, 8, 12, "one_ring")
]


def _lookahead(settings: Mapping[str, object]) -> int | None:
    # the ring is that of the most complete frame
    return None if settings["neighbours"] == "one_ring" else lookahead(settings)


@stepwise(
    "fill.lin_ouhyoung",
    cite=("lin_ouhyoung2005", "zhang_scattered"),
    adapted=(
        "from Lin and Ouhyoung 2005: by the equations of Zhang et al., the original could not "
        "be checked"
    ),
    lookahead=_lookahead,
)
def lin_ouhyoung(
    recording: Trajectories,
    *,
    neighbours: Neighbours = 8,
) -> Rule:
    """Fill gaps with a cosine-weighted mean of many neighbours' displacements (Lin & Ouhyoung).

    As formulated in Zhang et al., equations 6 and 7:
    ``w_i = cos((d_i - R_s) / (R_f - R_s) * pi / 2.5)`` and
    ``P'[t, m] = P[t-1, m] + sum(w_i (P[t, i] - P[t-1, i])) / sum(w_i)``, where d_i is the
    distance of neighbour i at t-1 and R_s, R_f are the nearest and the farthest of them. The
    weights lie between 0.309017 and 1; where R_f = R_s, equation 6 is 0/0 and all are 1.

    Markers missing in one frame are filled in marker order.

    The one ring is found once, in the most complete frame of the take.

    Parameters
    ----------
    neighbours
        How many of the nearest usable markers are weighted, fewer where there are fewer; or
        one_ring: the usable ones among those joined to the marker by a Delaunay triangulation.
        It is made in the most complete frame, seen from the front: projected on the plane of
        the first two principal axes of the markers, of which a face's depth is the third.
    """
    if neighbours != "one_ring":
        return Rule(weights="cosine", neighbours=neighbours)
    allowed = one_ring(recording)
    count = max(1, int(allowed.sum(axis=1).max(initial=1)))
    return Rule(weights="cosine", neighbours=count, allowed=allowed)


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
