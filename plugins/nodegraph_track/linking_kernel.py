"""The loops over tracks and points, compiled: import this module only when a tracker runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit

compiled: Callable[[Callable[..., Any]], Callable[..., Any]] = njit(cache=True, nogil=True)


@compiled
def pairs_within(places: Any, points: Any, gate: float) -> Any:
    """Return which points lie within the gate of which place.

    Parameters
    ----------
    places : (A, 3) array of float64
    points : (P, 3) array of float64
        In the order of x, so that few of them are looked at.
    gate
        Millimetres.

    Returns
    -------
    (K,), (K,), (K,) arrays
        Place, point, squared distance; place after place.
    """
    # Room for every pair, so that the search itself allocates nothing.
    place = np.empty(len(places) * len(points), np.int64)
    point, squared = np.empty(len(place), np.int64), np.empty(len(place))
    across = points[:, 0].copy()
    count, limit = 0, gate * gate
    for row in range(len(places)):
        x, y, z = places[row, 0], places[row, 1], places[row, 2]
        column = np.searchsorted(across, x - gate)
        while column < len(across) and across[column] <= x + gate:
            dx, dy, dz = across[column] - x, points[column, 1] - y, points[column, 2] - z
            distance = dx * dx + dy * dy + dz * dz
            if distance <= limit:
                place[count], point[count], squared[count] = row, column, distance
                count += 1
            column += 1
    return place[:count].copy(), point[:count].copy(), squared[:count].copy()


@compiled
def nearest_first(place: Any, point: Any, order: Any, places: int, points: int) -> Any:
    """Return the pairs that remain when each takes its place and its point, in some order.

    Parameters
    ----------
    place, point : (K,) arrays of int
        The pairs.
    order : (K,) array of int
        Which pair comes first, second, ...
    places, points
        How many there are.

    Returns
    -------
    (L,) array of int
        The pairs that were taken.
    """
    free_place, free_point = np.ones(places, np.bool_), np.ones(points, np.bool_)
    taken, count = np.empty(min(places, points), np.int64), 0
    for pair in order:
        if free_place[place[pair]] and free_point[point[pair]]:
            free_place[place[pair]] = free_point[point[pair]] = False
            taken[count] = pair
            count += 1
    return taken[:count]


@compiled
def components(place: Any, point: Any, places: int, points: int) -> Any:
    """Return the connected component of each pair, (K,): the smallest place in it."""
    of_place, of_point = np.arange(places), np.full(points, places)
    changed = True
    while changed:
        changed = False
        for pair in range(len(place)):
            row, column = place[pair], point[pair]
            least = min(of_place[row], of_point[column])
            changed |= of_place[row] != least or of_point[column] != least
            of_place[row] = of_point[column] = least
    return of_place[place]


@compiled
def carried(
    predicted: Any, last: Any, steps: Any, seen: Any, count: Any, track: Any, here: Any, frame: int
) -> Any:
    """Return the tracks after a frame: place, last point, steps, frame of it, number of points.

    Parameters
    ----------
    predicted, last, steps, seen, count
        Of all open tracks; see `nodegraph_track.follow.OpenTracks`.
    track : (L,) array of int
        Those that got a point.
    here : (L, 3) array of float64
        Their points.
    frame
        Which frame it is.
    """
    place, last, steps = predicted.copy(), last.copy(), steps.copy()
    seen, count = seen.copy(), count.copy()
    for link in range(len(track)):
        row = track[link]
        elapsed = frame - seen[row]
        for axis in range(3):
            now = here[link, axis]
            steps[row, 2, axis] = steps[row, 1, axis]
            steps[row, 1, axis] = steps[row, 0, axis]
            steps[row, 0, axis] = (now - last[row, axis]) / elapsed
            place[row, axis] = last[row, axis] = now
        seen[row] = frame
        count[row] += 1
    return place, last, steps, seen, count


@compiled
def alone(place: Any, point: Any, places: int, points: int) -> Any:
    """Return, for each pair, whether its place and its point are in no other, (K,) bool."""
    crowd, rivals = np.zeros(places, np.int64), np.zeros(points, np.int64)
    for pair in range(len(place)):
        crowd[place[pair]] += 1
        rivals[point[pair]] += 1
    return (crowd[place] == 1) & (rivals[point] == 1)


@compiled
def median_steps(steps: Any) -> Any:
    """Return the median of three steps, coordinate by coordinate: (A, 3, 3) to (A, 3)."""
    velocity = np.empty((len(steps), 3))
    for row in range(len(steps)):
        for axis in range(3):
            one, two, three = steps[row, 0, axis], steps[row, 1, axis], steps[row, 2, axis]
            velocity[row, axis] = max(min(one, two), min(max(one, two), three))
    return velocity
