"""k-means from many starts, compiled: import this module only when a method runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one. Nothing here runs in parallel: a run depends on its own start alone, and
graphs have other steps that can run meanwhile.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.int64]

compiled = partial(kernel, error_model="numpy")
inner = partial(compiled, no_cpython_wrapper=True)  # for kernels only
inlined = partial(kernel, forceinline=True, no_cpython_wrapper=True)

CAP = 300
"""Rounds after which a run stops, settled or not; runs on recorded faces take about ten."""

_DIMENSIONS, _PLACES = 4, 8
"""Numbers of dimensions and of places are filled up to multiples of these, which processors work
on at once; what is filled up takes no part in any result."""

_NEAR, _SMALL = 1e-9, 1e-13
"""Distances this close, relative and absolute, are equal: the two rows of a cluster of two are
equally far from their mean, and rounding must not choose between them."""


def restarts(rows: Floats, draws: Floats) -> tuple[Integers, Floats, Integers]:
    """Cluster rows by k-means from a random start per run.

    Parameters
    ----------
    rows : (p, q) array of float64
        The rows to cluster.
    draws : (R, k) array of float64
        Uniform in 0 to 1, a row per run; k of the p rows, all different, are drawn with them.

    Returns
    -------
    (R, k) array of int
        The row nearest to each cluster's mean, the first of equals; -1 for a cluster that lost
        all its rows.
    (R,) array of float64
        Sum of squared distances of the rows from their clusters' means.
    (R,) array of int
        Rounds until no row changed its cluster; `CAP` where that did not happen before.

    Raises
    ------
    ValueError
        If there are no clusters or more than rows, a row has no number, or a draw is not from 0
        up to but not 1: what is compiled would read and write beyond its arrays.
    """
    (runs, k), (p, q) = draws.shape, rows.shape
    if k < 1 or k > p or q < 1:
        raise ValueError("needs rows of one number or more, and from one cluster up to one a row")
    if not np.all((draws >= 0.0) & (draws < 1.0)):
        raise ValueError("draws must be from 0 up to but not 1")
    nearest, rounds = np.empty((runs, k), np.int64), np.empty(runs, np.int64)
    inertia = np.empty(runs)
    columns, squared = _aligned(q, _DIMENSIONS, p), _aligned(k, 2, p)
    columns[:q, :p] = rows.T
    squared[k:] = np.inf
    _restart(columns.T[:p].copy(), columns, draws, squared, nearest, inertia, rounds)
    return nearest, inertia, rounds


def _aligned(height: int, unit: int, width: int) -> Floats:
    """Return zeros, filled up, that begin where a cache line does, of 64 bytes or 8 numbers."""
    height, width = -(-height // unit) * unit, -(-width // _PLACES) * _PLACES
    room = np.zeros(height * width + 8)
    first = (64 - room.ctypes.data % 64) // 8 % 8
    return room[first : first + height * width].reshape((height, width))


@compiled("squared", "nearest", "inertia", "rounds")
def _restart(
    rows: Floats,
    columns: Floats,
    draws: Floats,
    squared: Floats,
    nearest: Integers,
    inertia: Floats,
    rounds: Integers,
) -> None:
    """Write what `restarts` returns."""
    (height, width), (p, k) = columns.shape, (len(rows), draws.shape[1])
    order, cluster = np.empty(p, np.int64), np.empty(p, np.int64)
    means, least = np.empty((k, height)), np.empty(width)
    for run in range(len(draws)):
        _draw(order, draws[run])
        for index in range(k):
            for dimension in range(height):
                means[index, dimension] = rows[order[index], dimension]
        rounds[run] = _settle(rows, columns, means, squared, cluster, least)
        inertia[run] = least[:p].sum()
        _find_nearest(nearest[run], cluster, np.sqrt(least[:p]))


@inlined("order")
def _draw(order: Integers, draws: Floats) -> None:
    """Put as many different numbers as there are draws, each equally likely, first."""
    count = len(order)
    for place in range(count):
        order[place] = place
    for place in range(len(draws)):
        other = place + int(draws[place] * (count - place))
        order[place], order[other] = order[other], order[place]


@inner("means", "squared", "cluster", "least")
def _settle(
    rows: Floats, columns: Floats, means: Floats, squared: Floats, cluster: Integers, least: Floats
) -> int:
    """Assign rows and take means in turn until no row changes its cluster; return the rounds.

    Distances from a mean that did not move are kept: they would come out the same, bit for bit.
    Those of all rows from the means that they were assigned to at last are left in `least`.
    """
    nearest, totals = np.empty(len(least), np.int64), np.empty_like(means)
    count, moved = np.empty(len(means), np.int64), np.ones(len(means), np.bool_)
    cluster[:] = -1
    for step in range(CAP + 1):
        for index in range(len(means)):
            if moved[index]:
                _measure(squared[index], columns, means[index])
        _assign(nearest, least, squared)
        changed = 0
        for place in range(len(cluster)):
            changed += cluster[place] != nearest[place]
            cluster[place] = nearest[place]
        if step == CAP or not changed:
            return step
        _add(totals, count, rows, cluster)
        _move(means, moved, totals, count)
    return CAP


@inlined("squared")
def _measure(squared: Floats, columns: Floats, mean: Floats) -> None:
    """Measure the squared distances of all rows from a mean; infinite from one of no rows."""
    squared[:] = 0.0 if mean[0] == mean[0] else np.inf
    for first in range(0, len(columns), _DIMENSIONS):
        w, x, y, z = columns[first], columns[first + 1], columns[first + 2], columns[first + 3]
        a, b, c, d = mean[first], mean[first + 1], mean[first + 2], mean[first + 3]
        for place in range(len(squared)):
            along, up, out, on = w[place] - a, x[place] - b, y[place] - c, z[place] - d
            squared[place] = (((squared[place] + along * along) + up * up) + out * out) + on * on


@inlined("nearest", "least")
def _assign(nearest: Integers, least: Floats, squared: Floats) -> None:
    """Find the nearest mean of each row, the first of equals."""
    least[:] = np.inf
    nearest[:] = 0
    for cluster in range(0, len(squared), 2):
        this, other = squared[cluster], squared[cluster + 1]
        for place in range(len(nearest)):
            closer = this[place] < least[place]
            low = this[place] if closer else least[place]
            who = cluster if closer else nearest[place]
            closer = other[place] < low
            least[place] = other[place] if closer else low
            nearest[place] = cluster + 1 if closer else who


@inner("totals", "count")
def _add(totals: Floats, count: Integers, rows: Floats, cluster: Integers) -> None:
    """Add up the rows of each cluster, and count them."""
    totals[:] = 0.0
    count[:] = 0
    for place in range(len(rows)):
        total, row = totals[cluster[place]], rows[place]
        for dimension in range(len(row)):
            total[dimension] += row[dimension]
        count[cluster[place]] += 1


@inner("means", "moved")
def _move(means: Floats, moved: Flags, totals: Floats, count: Integers) -> None:
    """Put the means where their clusters' are, NaN where no row is left; note which moved."""
    for cluster in range(len(means)):
        mean, total, rows, others = means[cluster], totals[cluster], float(count[cluster]), 0
        was_left = mean[0] != mean[0]
        for dimension in range(len(mean)):
            now = total[dimension] / rows
            others += now != mean[dimension]
            mean[dimension] = now
        moved[cluster] = others > 0 and not was_left


@inlined("nearest")
def _find_nearest(nearest: Integers, cluster: Integers, apart: Floats) -> None:
    """Find the row of each cluster that is nearest to its mean, the first of equals."""
    least = np.full(len(nearest), np.inf)
    for place in range(len(cluster)):
        least[cluster[place]] = min(least[cluster[place]], apart[place])
    nearest[:] = -1
    for place in range(len(cluster) - 1, -1, -1):
        own = cluster[place]
        if apart[place] <= least[own] * (1.0 + _NEAR) + _SMALL:
            nearest[own] = place
