"""Which track takes which point of a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Pairs = tuple[NDArray[np.intp], NDArray[np.intp]]
    """Places and points that belong together."""


def take_nearest(places: NDArray[np.float64], points: NDArray[np.float64], gate: float) -> Pairs:
    """Link places to points, the nearest pair first, then the nearest of those left, and so on.

    Parameters
    ----------
    places : (A, 3) array of float64
        Where the tracks are expected.
    points : (P, 3) array of float64
        In the order of x.
    gate
        Millimetres; no pair is farther apart.

    Returns
    -------
    (L,), (L,) arrays of int
        Place and point of each link; none twice.
    """
    from nodegraph_track import linking_kernel

    place, point, squared = linking_kernel.pairs_within(places, points, gate)
    order = np.argsort(squared, kind="stable")
    taken = linking_kernel.nearest_first(place, point, order, len(places), len(points))
    return place[taken], point[taken]


def assign(places: NDArray[np.float64], points: NDArray[np.float64], gate: float) -> Pairs:
    """Link places to points so that the whole fits best.

    Minimizes the sum of the squared distances of all links plus ``gate**2`` for each place that
    gets no point. Pairs that share neither place nor point, directly or through others, are
    solved apart.

    Parameters
    ----------
    places, points, gate
        As for `take_nearest`.

    Returns
    -------
    (L,), (L,) arrays of int
        As for `take_nearest`.
    """
    from nodegraph_track import linking_kernel

    place, point, squared = linking_kernel.pairs_within(places, points, gate)
    alone = linking_kernel.alone(place, point, len(places), len(points))
    if alone.all():
        return place, point
    linked = [np.flatnonzero(alone)]
    others = np.flatnonzero(~alone)
    group = linking_kernel.components(place[others], point[others], len(places), len(points))
    order = np.argsort(group, kind="stable")
    starts = np.flatnonzero(np.diff(group[order])) + 1
    for members in np.split(others[order], starts):
        linked.append(members[_best(place[members], point[members], squared[members], gate)])
    chosen = np.concatenate(linked)
    return place[chosen], point[chosen]


def _best(
    place: NDArray[np.intp], point: NDArray[np.intp], squared: NDArray[np.float64], gate: float
) -> NDArray[np.intp]:
    """Return which pairs of one component are linked."""
    from scipy.optimize import linear_sum_assignment

    rows, row = np.unique(place, return_inverse=True)
    columns, column = np.unique(point, return_inverse=True)
    pair = np.full((len(rows), len(columns)), -1)
    pair[row, column] = np.arange(len(place))
    # What leaving a place without a point costs; beyond any gate, more than all links together.
    alone = gate**2 if np.isfinite(gate) else 1.0 + squared.sum()
    cost = np.zeros(pair.shape)
    cost[row, column] = squared - alone
    chosen = pair[linear_sum_assignment(cost)]
    return np.asarray(chosen[chosen >= 0])
