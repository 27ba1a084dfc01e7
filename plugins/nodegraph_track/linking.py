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

    every = np.ones(len(places), np.bool_), np.ones(len(points), np.bool_)
    start, point, squared = linking_kernel.pairs_within(places, points, gate, *every)
    order = np.argsort(squared, kind="stable")
    return _links(linking_kernel.nearest_first(start, point, order, len(points)))


def assign(
    places: NDArray[np.float64],
    points: NDArray[np.float64],
    gate: float,
    *otherwise: NDArray[np.float64],
) -> Pairs:
    """Link places to points so that the whole fits best.

    Minimizes the sum of the squared distances of all links plus ``gate**2`` for each place that
    gets no point, by shortest augmenting paths.

    Parameters
    ----------
    places, points, gate
        As for `take_nearest`.
    otherwise : (A, 3) arrays of float64
        Where the places without a point are looked for next, among the points that are left, in
        the same way; and so on.

    Returns
    -------
    (L,), (L,) arrays of int
        As for `take_nearest`.
    """
    from nodegraph_track import linking_kernel

    in_turn = np.array([places, *otherwise])
    return _links(linking_kernel.assigned(in_turn, points, gate))


def _links(of_place: NDArray[np.intp]) -> Pairs:
    """Return place and point of those that have one."""
    place = np.flatnonzero(of_place >= 0)
    return place, of_place[place]
