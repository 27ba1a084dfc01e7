"""The loops over tracks and points, compiled: import this module only when a tracker runs.

A kernel calls only kernels of its own file: numba's cache notices an edit of no other.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

compiled = kernel()


@compiled
def spaces(points: Floats, offsets: Integers, frames: Integers) -> Floats:
    """Return how far each point of some frames is from the nearest one of its frame, (K,) mm.

    Parameters
    ----------
    points : (N, 3) array of float64
        Frame after frame, those of a frame in the order of x, so that few are looked at.
    offsets : (T + 1,) array of int
        The points of frame t are ``points[offsets[t]:offsets[t + 1]]``.
    frames : (F,) array of int
        Those of one point have no space.
    """
    distances, count = np.empty(len(points)), 0
    for frame in frames:
        first, end = offsets[frame], offsets[frame + 1]
        for row in range(first, end if end - first > 1 else first):
            nearest = np.inf
            for way in (-1, 1):
                other = row + way
                while first <= other < end:
                    dx = points[other, 0] - points[row, 0]
                    dy, dz = points[other, 1] - points[row, 1], points[other, 2] - points[row, 2]
                    if dx * dx > nearest:
                        break
                    nearest = min(nearest, dx * dx + dy * dy + dz * dz)
                    other += way
            distances[count] = np.sqrt(nearest)
            count += 1
    return distances[:count]


@compiled
def pairs_within(
    places: Floats, points: Floats, gate: float, wanting: Flags, free: Flags
) -> tuple[Integers, Integers, Floats]:
    """Return which points lie within the gate of which place.

    Parameters
    ----------
    places : (A, 3) array of float64
        Nothing is near one that is NaN.
    points : (P, 3) array of float64
        In the order of x, so that few of them are looked at.
    gate
        Millimetres.
    wanting : (A,) array of bool
    free : (P,) array of bool
        Other places and points are in no pair.

    Returns
    -------
    (A + 1,), (K,), (K,) arrays
        The first pair of each place; point and squared distance of each pair, by place, then
        point.
    """
    # Room for every pair, so that the search itself allocates nothing.
    point = np.empty(len(places) * len(points), np.int64)
    start, squared = np.empty(len(places) + 1, np.int64), np.empty(len(point))
    across = points[:, 0].copy()
    count, limit = 0, gate * gate
    for row in range(len(places)):
        start[row] = count
        x, y, z = places[row, 0], places[row, 1], places[row, 2]
        column = np.searchsorted(across, x - gate) if wanting[row] else len(across)
        while column < len(across) and across[column] <= x + gate:
            dx, dy, dz = across[column] - x, points[column, 1] - y, points[column, 2] - z
            distance = dx * dx + dy * dy + dz * dz
            if distance <= limit and free[column]:
                point[count], squared[count] = column, distance
                count += 1
            column += 1
    start[len(places)] = count
    return start, point[:count], squared[:count]


@compiled
def nearest_first(start: Integers, point: Integers, order: Integers, points: int) -> Integers:
    """Return the point of each place, (A,), -1 for none, when pairs are linked in some order.

    Parameters
    ----------
    start, point
        Pairs; see `pairs_within`.
    order : (K,) array of int
        Which pair comes first, second, ...; it is linked if its place and point still are free.
    points
        How many there are.
    """
    place, of_place = np.empty(len(point), np.int64), np.full(len(start) - 1, -1)
    for row in range(len(of_place)):
        place[start[row] : start[row + 1]] = row
    free = np.ones(points, np.bool_)
    for pair in order:
        if of_place[place[pair]] < 0 and free[point[pair]]:
            of_place[place[pair]] = point[pair]
            free[point[pair]] = False
    return of_place


@compiled
def assigned(in_turn: Floats, points: Floats, gate: float) -> Integers:
    """Return the point of each place by which the links are cheapest, (A,), -1 for none.

    Parameters
    ----------
    in_turn : (S, A, 3) array of float64
        The places; then where those that got no point are looked for among the points left.
    points, gate
        As for `pairs_within`.
    """
    of_place, free = np.full(in_turn.shape[1], -1), np.ones(len(points), np.bool_)
    for turn in range(len(in_turn)):
        wanting = of_place < 0
        if wanting.any() and free.any():
            start, point, squared = pairs_within(in_turn[turn], points, gate, wanting, free)
            # Beyond any gate: more than all links together.
            alone = gate * gate if np.isfinite(gate) else 1.0 + squared.sum()
            partners = cheapest(start, point, squared, len(points), alone)
            for row in range(len(partners)):
                if 0 <= partners[row] < len(points):
                    of_place[row] = partners[row]
                    free[partners[row]] = False
    return of_place


@compiled
def cheapest(
    start: Integers, point: Integers, squared: Floats, points: int, alone: float
) -> Integers:
    """Return the point of each place, (A,), by shortest augmenting paths.

    Place after place is added; the cheapest path of exchanges makes room for it. Behind the points
    stands, for each place, a column of its own, P and more: to have no point.

    Parameters
    ----------
    start, point, squared
        Pairs; see `pairs_within`.
    points
        How many there are.
    alone
        The cost of a place without a point.
    """
    places = len(start) - 1
    of_row, of_column = np.full(places, -1), np.full(points + places, -1)
    row_price, column_price = np.zeros(places), np.zeros(points + places)
    cost, back = np.full(points + places, np.inf), np.empty(points + places, np.int64)
    done, touched = np.zeros(points + places, np.bool_), np.empty(points + places, np.int64)
    for root in range(places):
        row, reached, count, end = root, 0.0, 0, -1
        while row >= 0:
            for pair in range(start[row], start[row + 1] + 1):
                none = pair == start[row + 1]
                column = points + row if none else point[pair]
                price = alone if none else squared[pair]
                total = reached + price - row_price[row] - column_price[column]
                if total < cost[column] and not done[column]:
                    if cost[column] == np.inf:
                        touched[count] = column
                        count += 1
                    cost[column], back[column] = total, row
            end = _cheapest_open(touched[:count], cost, done)
            done[end], reached, row = True, cost[end], of_column[end]
        row_price[root] += reached
        # The prices keep what is left of every cost from being negative, and of every link 0.
        for column in touched[:count]:
            if done[column] and column != end:
                row_price[of_column[column]] += reached - cost[column]
                column_price[column] -= reached - cost[column]
            cost[column], done[column] = np.inf, False
        while end >= 0:
            row = back[end]
            of_column[end] = row
            end, of_row[row] = of_row[row], end
    return of_row


@compiled
def _cheapest_open(columns: Integers, cost: Floats, done: Flags) -> int:
    best = -1
    for column in columns:
        if not done[column] and (best < 0 or cost[column] < cost[best]):
            best = column
    return best
