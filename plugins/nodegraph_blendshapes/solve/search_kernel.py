"""Least squares within bounds where columns may depend on each other, compiled.

The active-set method of Stark & Parker (1995), which is that of Lawson & Hanson (1974) for two
bounds: some weights are free and the others stay. The free ones are solved for, by Householder's
reflections, as normal equations would square what little tells such columns apart; where that
leads out of the bounds, the way there is gone as far as it leads within them, and the weight that
stops it is bound. Where it does not, the weight that the gradient pulls the most is freed. The sum
of squares falls with each weight that is freed, so that no set of free weights comes twice; one
with which it does not fall, by rounding, is not freed again until it has. All begin at rest, at 0.
In the end, where large weights cancel, the free ones are refined by what they leave of the target
with the columns as they were given, of which the turned ones are but the nearest doubles. Import
this module only when one runs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = kernel(error_model="numpy", fastmath={"reassoc", "contract"})

PULL = 1e-14
"""A gradient is zero up to this share of ``|column| |target|``, what rounding leaves of it."""

DEPENDENT = 1e-13
"""A column of which no larger share is at right angles to the free ones is not freed."""

CANCEL = 100.0
"""Weights cancel where ``sum(|weight| |column|)`` is this many times the target's length."""

AT_LOW, AT_HIGH, AT_REST, FREE = 0, 1, 2, 3


class Squares(NamedTuple):
    """A sum of squares ``|sum(w[k] columns[k]) - target|^2`` over weights w within bounds.

    Attributes
    ----------
    columns : (K, R) array of float64
    lengths : (K,) array of float64
        Of the columns.
    low, high : float
        0 is not outside of them.
    """

    columns: Floats
    lengths: Floats
    low: float
    high: float


class System(NamedTuple):
    """The columns and targets before they were turned by ``coordinates``.

    Attributes
    ----------
    columns : (K, S) array of float64
        The turned ones are ``columns coordinates'``.
    targets : (N, S) array of float64
    coordinates : (R, S) array of float64
    """

    columns: Floats
    targets: Floats
    coordinates: Floats


class Work(NamedTuple):
    """State of a search.

    Attributes
    ----------
    weights, ahead, slope : (K,) arrays of float64
        The weights, where the free ones lead, the gradient.
    diagonal, half : (K,) arrays of float64
        Of the triangle; minus half of each mirror's squared length.
    place : (K,) array of int8
        `AT_LOW`, `AT_HIGH`, `AT_REST` between the two, or `FREE`.
    refused : (K,) array of bool
        Weights that are not to be freed: rounding alone pulls them.
    order : (K,) array of int64
        The free weights, as they were freed.
    size : (1,) array of int64
        How many are free.
    table : (K + 1, R) array of float64
        A row for each free column, the triangle's left of the diagonal and a mirror from there on;
        and what the columns are to give, reflected.
    """

    weights: Floats
    ahead: Floats
    slope: Floats
    diagonal: Floats
    half: Floats
    place: Integers
    refused: Flags
    order: Integers
    size: Integers
    table: Floats


@compiled
def search(
    squares: Squares, targets: Floats, system: System, most: int, solution: Floats, free: Flags
) -> None:
    """Write weights of least squares of each target, of which there may be several.

    Parameters
    ----------
    squares : Squares
    targets : (N, R) array of float64
    system : System
    most
        How many weights may be freed for a target. Where that is not enough, the weights are
        within the bounds, and their squares not the least.
    solution : (N, K) array of float64
        Written.
    free : (N, K) array of bool
        Written: which weights are free; their columns do not depend on each other.
    """
    work = _new_work(squares)
    for frame in range(len(targets)):
        _begin(squares, work)
        _search(squares, targets[frame], work, most)
        if _cancel(squares, targets[frame], work):
            _refine(squares, system, system.targets[frame], work)
        solution[frame] = work.weights
        free[frame] = work.place == FREE


@compiled
def _new_work(squares: Squares) -> Work:
    count, height = squares.columns.shape
    return Work(
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.zeros(count),
        np.zeros(count, np.int8),
        np.zeros(count, np.bool_),
        np.zeros(count, np.int64),
        np.zeros(1, np.int64),
        np.zeros((count + 1, height)),
    )


@compiled
def _begin(squares: Squares, work: Work) -> None:
    work.weights[:] = 0.0
    work.refused[:] = False
    work.size[0] = 0
    work.place[:] = AT_REST
    if squares.low == 0.0:
        work.place[:] = AT_LOW
    elif squares.high == 0.0:
        work.place[:] = AT_HIGH


@compiled
def _search(squares: Squares, target: Floats, work: Work, most: int) -> None:
    least = _squares_and_slope(squares, target, work)
    enough = PULL * math.sqrt(least)
    for _ in range(most):
        newest = _most_pulled(squares, work, enough)
        if newest < 0 or work.size[0] == len(target):
            return
        before = work.place[newest]
        work.place[newest] = FREE
        work.order[work.size[0]] = newest
        work.size[0] += 1
        _look_ahead(squares, target, work, work.size[0] - 1)
        if abs(work.diagonal[work.size[0] - 1]) <= DEPENDENT * squares.lengths[newest]:
            work.size[0] -= 1
            work.place[newest] = before
            work.refused[newest] = True
            continue
        stop = _go(squares, work)
        while stop >= 0:
            _look_ahead(squares, target, work, stop)
            stop = _go(squares, work)
        value = _squares_and_slope(squares, target, work)
        if value < least:
            least = value
            work.refused[:] = False
        else:
            work.refused[newest] = True


@compiled
def _dot(left: Floats, right: Floats, count: int) -> float:
    total = 0.0
    for k in range(count):
        total += left[k] * right[k]
    return total


@compiled
def _add(target: Floats, other: Floats, factor: float, count: int) -> None:
    for k in range(count):
        target[k] += other[k] * factor


@compiled
def _squares_and_slope(squares: Squares, target: Floats, work: Work) -> float:
    """Write the gradient, and return the sum of squares."""
    rest = -target
    for j in range(len(work.weights)):
        if work.weights[j] != 0.0:
            _add(rest, squares.columns[j], work.weights[j], len(rest))
    for j in range(len(work.weights)):
        work.slope[j] = _dot(squares.columns[j], rest, len(rest))
    return _dot(rest, rest, len(rest))


@compiled
def _most_pulled(squares: Squares, work: Work, enough: float) -> int:
    """Return which weight that is not free the gradient pulls inwards the most, or -1."""
    most, best = enough, -1
    for j in range(len(work.weights)):
        if work.place[j] == FREE or work.refused[j]:
            continue
        pull = -work.slope[j]
        if work.place[j] == AT_HIGH or (work.place[j] == AT_REST and pull < 0.0):
            pull = -pull
        if pull > most * squares.lengths[j]:
            most, best = pull / squares.lengths[j], j
    return best


@compiled
def _look_ahead(squares: Squares, target: Floats, work: Work, begin: int) -> None:
    """Write where the free weights have the least squares, the others staying.

    Rows of the table before `begin` are as they were.
    """
    size, height = work.size[0], len(target)
    for k in range(begin, size):
        work.table[k] = squares.columns[work.order[k]]
        _reflect(work, work.table[k], k)
        mirror = work.table[k, k:]
        length = math.sqrt(_dot(mirror, mirror, height - k))
        work.diagonal[k] = -length if mirror[0] >= 0.0 else length
        mirror[0] -= work.diagonal[k]
        work.half[k] = work.diagonal[k] * mirror[0]
    rest = work.table[size]
    rest[:] = target
    for j in range(len(work.weights)):
        if work.place[j] != FREE and work.weights[j] != 0.0:
            _add(rest, squares.columns[j], -work.weights[j], height)
    _solve(work, rest)


@compiled
def _solve(work: Work, rest: Floats) -> None:
    """Write what the free columns give `rest` with, as nearly as they can."""
    _reflect(work, rest, work.size[0])
    for k in range(work.size[0] - 1, -1, -1):
        work.ahead[k] = rest[k] / work.diagonal[k]
        _add(rest, work.table[k], -work.ahead[k], k)


@compiled
def _reflect(work: Work, row: Floats, count: int) -> None:
    """Reflect a row by the first mirrors, one after the other."""
    for k in range(count):
        if work.half[k] != 0.0:
            mirror, beyond = work.table[k, k:], row[k:]
            _add(beyond, mirror, _dot(mirror, beyond, len(mirror)) / work.half[k], len(mirror))


@compiled
def _go(squares: Squares, work: Work) -> int:
    """Go ahead as far as the bounds let; bind the weight that stops.

    Returns where in the order it was, or -1 if none did.
    """
    share, stop, bound, place = 1.0, -1, 0.0, FREE
    for k in range(work.size[0]):
        here, there = work.weights[work.order[k]], work.ahead[k]
        if there < squares.low and squares.low - here >= share * (there - here):
            share, stop = (squares.low - here) / (there - here), k
            bound, place = squares.low, AT_LOW
        elif there > squares.high and squares.high - here <= share * (there - here):
            share, stop = (squares.high - here) / (there - here), k
            bound, place = squares.high, AT_HIGH
    for k in range(work.size[0]):
        i = work.order[k]
        gone = work.weights[i] + share * (work.ahead[k] - work.weights[i])
        gone = work.ahead[k] if stop < 0 else gone
        work.weights[i] = min(max(gone, squares.low), squares.high)
    if stop >= 0:
        work.weights[work.order[stop]] = bound
        work.place[work.order[stop]] = place
        work.size[0] -= 1
        for k in range(stop, work.size[0]):
            work.order[k] = work.order[k + 1]
    return stop


@compiled
def _cancel(squares: Squares, target: Floats, work: Work) -> bool:
    total = 0.0
    for j in range(len(work.weights)):
        total += abs(work.weights[j]) * squares.lengths[j]
    return bool(total > CANCEL * math.sqrt(_dot(target, target, len(target))))


@compiled
def _refine(squares: Squares, system: System, target: Floats, work: Work) -> None:
    """Take from the free weights what turning the columns has cost in accuracy."""
    left = target.copy()
    for j in range(len(work.weights)):
        if work.weights[j] != 0.0:
            _add(left, system.columns[j], -work.weights[j], len(left))
    rest = work.table[work.size[0]]
    for k in range(len(rest)):
        rest[k] = _dot(system.coordinates[k], left, len(left))
    _solve(work, rest)
    for k in range(work.size[0]):
        i = work.order[k]
        work.weights[i] = min(max(work.weights[i] + work.ahead[k], squares.low), squares.high)
