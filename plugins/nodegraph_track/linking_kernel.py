"""The loops over tracks and points, compiled: import this module only when a tracker runs.

A kernel calls only kernels of its own file: numba's cache notices an edit of no other.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

inner = partial(kernel, no_cpython_wrapper=True)  # for kernels only

_FARTHEST = 1.7e308
"""Squared mm that are still no infinity."""


@kernel()
def spaces(points: Floats, offsets: Integers, frames: Integers) -> Floats:
    """Return the distance of each point of some frames to the nearest of its frame, (K,) mm.

    Parameters
    ----------
    points : (N, 3) array of float64
        Frame after frame, those of a frame in the order of x, so that few are looked at.
    offsets : (T + 1,) array of int
        The points of frame t are ``points[offsets[t]:offsets[t + 1]]``.
    frames : (F,) array of int
        Frames to look at; those of one point have no space.
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


@kernel()
def pairs_within(
    places: Floats, points: Floats, gate: float, wanting: Flags, free: Flags
) -> tuple[Integers, Integers, Floats]:
    """Return the points within the gate of each place.

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


def nearest_first(places: Floats, points: Floats, gate: float) -> Integers:
    """Return the point of each place, (A,), -1 for none: the nearest pair of all first, and so on.

    Parameters
    ----------
    places, points, gate
        As for `pairs_within`.
    """
    every = np.ones(max(len(places), len(points)), np.bool_)
    start, point, squared = pairs_within(
        places, points, gate, every[: len(places)], every[: len(points)]
    )
    # numba takes as long to compile its own sort as all else of a tracker
    return taken_in_order(start, point, np.argsort(squared, kind="stable"), len(points))


@kernel()
def taken_in_order(start: Integers, point: Integers, order: Integers, points: int) -> Integers:
    """Return the point of each place, where pairs whose place and point are free become links."""
    of_place, free = np.full(len(start) - 1, -1), np.ones(points, np.bool_)
    place = np.empty(len(point), np.int64)
    for row in range(len(of_place)):
        for pair in range(start[row], start[row + 1]):
            place[pair] = row
    for pair in order:
        if of_place[place[pair]] < 0 and free[point[pair]]:
            of_place[place[pair]] = point[pair]
            free[point[pair]] = False
    return of_place


@kernel()
def assigned(in_turn: Floats, points: Floats, gate: float) -> Integers:
    """Return the point of each place by which the links are cheapest, (A,), -1 for none.

    Minimizes the sum of the squared distances of all links plus ``gate**2`` for each place that
    gets no point.

    Parameters
    ----------
    in_turn : (S, A, 3) array of float64
        The places; then where those that got no point are looked for among the points left, in the
        same way.
    points, gate
        As for `pairs_within`.
    """
    of_place, free = np.full(in_turn.shape[1], -1), np.ones(len(points), np.bool_)
    for turn in range(len(in_turn)):
        _assign(in_turn[turn], points, gate, of_place, free)
    return of_place


@inner("of_place", "free")
def _assign(places: Floats, points: Floats, gate: float, of_place: Integers, free: Flags) -> None:
    """Give free points to the places without one, and write both."""
    wanting = of_place < 0
    if not (wanting.any() and free.any()):
        return
    start, point, squared = pairs_within(places, points, gate, wanting, free)
    if _take_nearest(start, point, squared, of_place, free):
        return
    # Beyond any gate: more than all links together.
    alone = gate * gate if np.isfinite(gate) else 1.0 + squared.sum()
    partners = cheapest(start, point, squared, len(points), alone)
    for row in range(len(partners)):
        if 0 <= partners[row] < len(points):
            of_place[row] = partners[row]
            free[partners[row]] = False


@inner("of_place", "free")
def _take_nearest(
    start: Integers, point: Integers, squared: Floats, of_place: Integers, free: Flags
) -> bool:
    """Give each place its nearest point if no two places have the same; return whether it is so.

    No links can be cheaper, since none of a place is. `cheapest` finds the same ones.
    """
    for row in range(len(of_place)):
        if start[row] == start[row + 1]:
            continue
        best = start[row]
        for pair in range(best + 1, start[row + 1]):
            if squared[pair] < squared[best]:
                best = pair
        if not free[point[best]]:
            for earlier in range(row):  # as it was
                if start[earlier] < start[earlier + 1]:
                    free[of_place[earlier]] = True
                    of_place[earlier] = -1
            return False
        of_place[row] = point[best]
        free[point[best]] = False
    return True


@kernel("near")
def assigned_by_neighbours(
    tracks: Any, points: Floats, frame: int, gate: float, rounds: int, near: Integers
) -> tuple[Floats, Integers]:
    """Return where the neighbours' motion leads each track, (A, 3), and its point; -1 for none.

    Parameters
    ----------
    tracks
        See `nodegraph_track.follow.OpenTracks`.
    points, gate
        As for `pairs_within`.
    frame
    rounds
        How often motion and links are found from each other, at most.
    near : (A, N) array of int
        Written; see `carried_by_neighbours`.
    """
    absent = frame - 1 - tracks.seen
    alone = carried_by_velocity(tracks.place, tracks.steps, absent, 0.0)
    expected = alone.copy()
    for row in range(len(alone)):
        if absent[row]:
            expected[row] = np.nan
    of_place, free = np.empty(len(alone), np.int64), np.empty(len(points), np.bool_)
    of_seen, settled = np.full(len(alone), -1), False
    moved, motion = np.empty(len(alone), np.int64), np.empty((len(alone), 3))
    for count in range(rounds):
        of_place[:], free[:] = -1, True
        _assign(expected, points, gate, of_place, free)
        settled, links = count > 0, 0
        for row in range(len(alone)):
            point = -1 if absent[row] else of_place[row]
            settled &= point == of_seen[row]
            of_seen[row] = point
            if point >= 0:
                moved[links] = row
                for axis in range(3):
                    motion[links, axis] = points[point, axis] - tracks.place[row, axis]
                links += 1
        if settled:
            break
        expected = carried_by_neighbours(tracks.place, moved[:links], motion[:links], near, alone)
    if not settled:
        of_place[:], free[:] = -1, True
        _assign(expected, points, gate, of_place, free)
    _assign(alone, points, gate, of_place, free)
    _assign(expected - tracks.jump, points, gate, of_place, free)
    return expected, of_place


@inner()
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


@inner()
def _cheapest_open(columns: Integers, cost: Floats, done: Flags) -> int:
    best = -1
    for column in columns:
        if not done[column] and (best < 0 or cost[column] < cost[best]):
            best = column
    return best


@kernel()
def carried_by_velocity(place: Floats, steps: Floats, absent: Integers, fade: float) -> Floats:
    """Return places moved by the median of their last steps, (A, 3).

    Parameters
    ----------
    place : (A, 3) array of float64
    steps : (A, 3, 3) array of float64
        mm per frame between the last four points. The median is that of each coordinate.
    absent : (A,) array of int
        For how many frames no point was found.
    fade
        The share that is left of the velocity after each of these.
    """
    result = np.empty((len(place), 3))
    for row in range(len(place)):
        left = fade ** float(absent[row])
        for axis in range(3):
            first, second, third = steps[row, 0, axis], steps[row, 1, axis], steps[row, 2, axis]
            median = max(min(first, second), min(max(first, second), third))
            result[row, axis] = place[row, axis] + left * median
    return result


@kernel("near")
def carried_by_neighbours(
    place: Floats, moved: Integers, motion: Floats, near: Integers, otherwise: Floats
) -> Floats:
    """Return places moved by the median motion of their nearest neighbours, (A, 3).

    Parameters
    ----------
    place : (A, 3) array of float64
    moved : (L,) array of int
        The places whose motion is known, each once.
    motion : (L, 3) array of float64
        mm.
    near : (A, N) array of int
        The N places, at most, of the neighbours of each, itself not among them; written. At
        first those of the frame before, by which the search is shorter, or the place itself.
    otherwise : (A, 3) array of float64
        Where a place without any neighbour is.
    """
    values = np.empty((near.shape[1], len(place), 3))
    link_of = np.full(len(place), -1)
    for link in range(len(moved)):
        link_of[moved[link]] = link
    counts, is_full = _nearest_others(place, moved, link_of, near), len(place) > 0
    for row in range(len(place)):
        is_full &= counts[row] == len(values)
        for rank in range(counts[row]):
            link = link_of[near[row, rank]]
            for axis in range(3):
                values[rank, row, axis] = motion[link, axis]
    result = otherwise.copy()
    if is_full:
        _sort_all(values.reshape(len(values), -1))
    else:
        for row in range(len(place)):
            for axis in range(3):
                _sort(values[: counts[row], row, axis])
    for row in range(len(place)):
        middle, other = counts[row] // 2, (counts[row] - 1) // 2
        for axis in range(3 if counts[row] else 0):
            median = (values[middle, row, axis] + values[other, row, axis]) / 2.0
            result[row, axis] = place[row, axis] + median
    return result


@inner("near")
def _nearest_others(place: Floats, moved: Integers, link_of: Integers, near: Integers) -> Integers:
    """Write the nearest places that moved to each, and return how many, (A,).

    Parameters
    ----------
    place, moved, near
        As for `carried_by_neighbours`.
    link_of : (A,) array of int
        Where each place stands in `moved`, -1 if it does not.
    """
    most, counts = near.shape[1], np.empty(len(place), np.int64)
    others, squared = np.empty((3, len(moved))), np.empty(len(moved))
    for link in range(len(moved)):
        for axis in range(3):
            others[axis, link] = place[moved[link], axis]
    x, y, z = others[0], others[1], others[2]
    which, smallest = np.empty(len(moved) + 1, np.int64), np.empty(most)
    for row in range(len(place)):
        for link in range(len(moved)):
            dx, dy, dz = x[link] - place[row, 0], y[link] - place[row, 1], z[link] - place[row, 2]
            squared[link] = dx * dx + dy * dy + dz * dz
        if link_of[row] >= 0:
            squared[link_of[row]] = np.inf
        # The nearest are no farther than the farthest of as many others.
        farthest = 0.0
        for rank in range(most):
            link = link_of[near[row, rank]]
            farthest = max(farthest, squared[link]) if link >= 0 else np.inf
        farthest, count = min(farthest, _FARTHEST), 0
        for link in range(len(moved)):  # without a branch, which could not be foreseen
            which[count] = link
            count += squared[link] <= farthest
        if count > most:
            count = _smallest(squared, which[:count], smallest)
        for rank in range(most):
            near[row, rank] = moved[which[rank]] if rank < count else row
        counts[row] = count
    return counts


@inner("which", "smallest")
def _smallest(values: Floats, which: Integers, smallest: Floats) -> int:
    """Put first which of some values are the smallest, the least first; return how many."""
    count, most = 0, len(smallest)
    for index in which:
        value = values[index]
        if count == most and value >= smallest[most - 1]:
            continue
        rank = min(count, most - 1)
        count = rank + 1
        while rank > 0 and smallest[rank - 1] > value:
            smallest[rank], which[rank] = smallest[rank - 1], which[rank - 1]
            rank -= 1
        smallest[rank], which[rank] = value, index
    return count


@inner("columns")
def _sort_all(columns: Floats) -> None:
    """Sort each of (N, C) columns, all at once: neighbours change places in N rounds."""
    for turn in range(len(columns)):
        for upper in range(turn % 2, len(columns) - 1, 2):
            first, second = columns[upper], columns[upper + 1]
            for column in range(columns.shape[1]):
                above, below = first[column], second[column]
                first[column] = above if above < below else below
                second[column] = below if above < below else above


@inner("values")
def _sort(values: Floats) -> None:
    """Sort a few values."""
    for end in range(1, len(values)):
        value, rank = values[end], end
        while rank > 0 and values[rank - 1] > value:
            values[rank] = values[rank - 1]
            rank -= 1
        values[rank] = value
