"""How tracks move, compiled: import this module only when a tracker runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.intp]

compiled = kernel()


@compiled
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
        What is left of the velocity after each of these.
    """
    result = np.empty((len(place), 3))
    for row in range(len(place)):
        left = fade ** float(absent[row])
        for axis in range(3):
            first, second, third = steps[row, 0, axis], steps[row, 1, axis], steps[row, 2, axis]
            median = max(min(first, second), min(max(first, second), third))
            result[row, axis] = place[row, axis] + left * median
    return result


@compiled
def carried_by_neighbours(
    place: Floats, moved: Integers, motion: Floats, neighbours: int, otherwise: Floats
) -> Floats:
    """Return places moved by the median motion of their nearest neighbours, (A, 3).

    Parameters
    ----------
    place : (A, 3) array of float64
    moved : (L,) array of int
        The places whose motion is known, each once.
    motion : (L, 3) array of float64
        mm.
    neighbours
        How many of these, the place itself not among them, at most.
    otherwise : (A, 3) array of float64
        Where a place without any neighbour is.
    """
    result, values = otherwise.copy(), np.empty(neighbours)
    near, apart = np.empty(neighbours, np.int64), np.empty(neighbours)
    others, squared = place[moved], np.empty(len(moved))
    x, y, z = others[:, 0].copy(), others[:, 1].copy(), others[:, 2].copy()
    for row in range(len(place)):
        for link in range(len(moved)):
            dx, dy, dz = x[link] - place[row, 0], y[link] - place[row, 1], z[link] - place[row, 2]
            squared[link] = dx * dx + dy * dy + dz * dz
        squared[moved == row] = np.inf
        count = _smallest(squared, near, apart)
        for axis in range(3 if count else 0):
            for rank in range(count):
                values[rank] = motion[near[rank], axis]
            result[row, axis] = place[row, axis] + _median(values[:count])
    return result


@compiled
def _smallest(values: Floats, which: Integers, smallest: Floats) -> int:
    """Write which values are smallest, and these, the least first; return how many there are."""
    count, most = 0, len(smallest)
    for index in range(len(values)):
        value = values[index]
        if value == np.inf or (count == most and value >= smallest[most - 1]):
            continue
        rank = min(count, most - 1)
        count = rank + 1
        while rank > 0 and smallest[rank - 1] > value:
            smallest[rank], which[rank] = smallest[rank - 1], which[rank - 1]
            rank -= 1
        smallest[rank], which[rank] = value, index
    return count


@compiled
def _median(values: Floats) -> float:
    """Return the median, and sort the values: a few of them only."""
    for end in range(1, len(values)):
        value, rank = values[end], end
        while rank > 0 and values[rank - 1] > value:
            values[rank] = values[rank - 1]
            rank -= 1
        values[rank] = value
    middle = len(values) // 2
    median: float = (values[middle] + values[(len(values) - 1) // 2]) / 2.0
    return median
