"""Least squares within bounds by normal equations, frame by frame, compiled.

The block pivoting of Portugal, Judice & Vicente (1994): some weights are free and the others at a
bound. The free ones are solved for; then all weights on the wrong side are exchanged at once, the
free ones that are beyond a bound and the bound ones that the gradient pulls inwards, until none is
left. Mostly that takes two or three rounds. Where their number does not fall for some rounds, only
the last of them is exchanged, which cannot go round in circles (Murty, 1974), until it does fall.
Each frame starts from the free weights of the one before.

Where columns depend on each other, a ridge makes the weights the only ones, and what it takes from
the squares is given back step by step: the proximal point method (Rockafellar, 1976). Each answer
is held against the conditions for a least. Import this module only when one runs.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = partial(kernel, error_model="numpy", fastmath={"reassoc", "contract"})
inner = partial(compiled, no_cpython_wrapper=True)  # for kernels only

PULL = 1e-14
"""A gradient is zero up to this share of ``|column| |target|``, what rounding leaves of it."""

AT_LOW, AT_HIGH, FREE = 0, 1, 2
_ROUNDS = 4
_LITTLE = 1e-14
_APPROACHES = 10_000
_FINE = 59
"""After so many approaches, what the caller asks for is enough."""
_NOTHING = 1e-300


class Squares(NamedTuple):
    """A sum of squares ``|sum(w[k] columns[k]) - target|^2`` over weights w within bounds.

    Attributes
    ----------
    columns : (K, R) array of float64
    gram : (K, K) array of float64
        ``columns columns'``, with the ridge on its diagonal.
    lengths : (K,) array of float64
        Lengths of the columns.
    low, high, ridge : float
    """

    columns: Floats
    gram: Floats
    lengths: Floats
    low: float
    high: float
    ridge: float


class Work(NamedTuple):
    """Where a search stands: the weights, which are free, and Cholesky's factor for these.

    Attributes
    ----------
    weights, ahead, slope : (K,) arrays of float64
        The weights, the solution for the free ones, the gradient.
    place : (K,) array of int8
        `AT_LOW`, `AT_HIGH` or `FREE`.
    wrong : (K,) array of bool
        Weights to be exchanged.
    order : (K,) array of int64
        The free weights, as the factor has them.
    size : (1,) array of int64
        How many are free; -1 before the search begins.
    factor : (K, K) array of float64
    """

    weights: Floats
    ahead: Floats
    slope: Floats
    place: Integers
    wrong: Flags
    order: Integers
    size: Integers
    factor: Floats


@compiled("work", "solution", "solved")
def bounded(
    squares: Squares,
    targets: Floats,
    linears: Floats,
    work: Work,
    most: int,
    share: float,
    solution: Floats,
    solved: Flags,
) -> None:
    """Write the weights of least squares of each target, and whether they are.

    Parameters
    ----------
    squares : Squares
    targets : (N, R) array of float64
    linears : (N, K) array of float64
        ``columns target``.
    work
        Where the search of the target before stands, or `new_work`; written.
    most
        How many rounds of exchanges a target gets.
    share
        What a gradient may be that does not push against a bound; see `bounded.are_least`.
        Infinite where the caller will tell, and `solved` is not written.
    solution : (N, K) array of float64
        Written: within the bounds in any case.
    solved : (N,) array of bool
        Written.
    """
    rest, linear = np.empty(targets.shape[1]), np.empty(linears.shape[1])
    for frame in range(len(targets)):
        target, weights = targets[frame], solution[frame]
        length = math.sqrt(_dot(target, target, len(target)))
        weights[:] = 0.0
        # with a ridge, what rounding leaves must not depend on the target before
        if squares.ridge > 0.0 or work.size[0] < 0:
            _free_all(squares, work)
        for approach in range(_APPROACHES if squares.ridge > 0.0 else 1):
            for k in range(len(weights)):
                linear[k] = linears[frame, k] + squares.ridge * weights[k]
            is_settled = _exchange(squares, linear, work, length, most)
            _refine(squares, target, weights, rest, work)
            _copy(weights, work.weights)
            if math.isinf(share):
                break
            left = _left(squares, target, rest, work, length)
            if left > share and squares.ridge == 0.0 and _mark(squares, work, length):
                # rounding of the normal equations has hidden that weights are at the wrong bound
                _factorize(squares.gram, work, _swap(squares, work))
                _free_ones(squares, linear, work)
                _refine(squares, target, weights, rest, work)
                _copy(weights, work.weights)
                left = _left(squares, target, rest, work, length)
            solved[frame] = left <= share
            if left <= (_LITTLE if approach < _FINE else share) or not is_settled:
                break


@inner("rest", "work")
def _left(squares: Squares, target: Floats, rest: Floats, work: Work, length: float) -> float:
    """Return the largest gradient that pulls inwards, as a share, and write the gradient."""
    weights, reach, worst = work.weights, length, 0.0
    _copy(rest, target)
    for k in range(len(weights)):
        if weights[k] != 0.0:
            _add(rest, squares.columns[k], -weights[k], len(rest))
            reach += abs(weights[k]) * squares.lengths[k]
    for k in range(len(weights)):
        downhill = _dot(squares.columns[k], rest, len(rest))
        work.slope[k] = -downhill
        is_out = weights[k] <= squares.low if downhill < 0.0 else weights[k] >= squares.high
        if not is_out:
            worst = max(worst, abs(downhill) / squares.lengths[k])
    return worst / reach if reach > 0.0 else 0.0


def new_work(count: int) -> Work:
    """Return a search for so many weights that has not begun."""
    return Work(
        weights=np.zeros(count),
        ahead=np.zeros(count),
        slope=np.zeros(count),
        place=np.zeros(count, np.int8),
        wrong=np.zeros(count, np.bool_),
        order=np.zeros(count, np.int64),
        size=np.full(1, -1),
        factor=np.zeros((count, count)),
    )


@inner("work")
def _free_all(squares: Squares, work: Work) -> None:
    work.weights[:] = 0.0
    work.place[:] = FREE
    for k in range(len(work.order)):
        work.order[k] = k
    work.size[0] = len(work.order)
    _factorize(squares.gram, work, 0)


@inner()
def _dot(left: Floats, right: Floats, count: int) -> float:
    total = 0.0
    for k in range(count):
        total += left[k] * right[k]
    return total


@inner("target")
def _copy(target: Floats, other: Floats) -> None:
    for k in range(len(target)):
        target[k] = other[k]


@inner("target")
def _add(target: Floats, other: Floats, factor: float, count: int) -> None:
    for k in range(count):
        target[k] += other[k] * factor


@inner("work")
def _factorize(gram: Floats, work: Work, begin: int) -> None:
    """Write the factor's rows from `begin` on."""
    factor, order = work.factor, work.order
    for i in range(begin, work.size[0]):
        row, entries = factor[i], gram[order[i]]
        for k in range(i):
            row[k] = (entries[order[k]] - _dot(row, factor[k], k)) / factor[k, k]
        row[i] = math.sqrt(max(entries[order[i]] - _dot(row, row, i), _NOTHING))


@inner("work")
def _solve(work: Work) -> None:
    """Replace the right-hand side in `ahead` by the solution for the free weights."""
    factor, ahead = work.factor, work.ahead
    for i in range(work.size[0]):
        ahead[i] = (ahead[i] - _dot(factor[i], ahead, i)) / factor[i, i]
    for i in range(work.size[0] - 1, -1, -1):
        ahead[i] /= factor[i, i]
        _add(ahead, factor[i], -ahead[i], i)


@inner("work")
def _exchange(squares: Squares, linear: Floats, work: Work, length: float, most: int) -> bool:
    """Exchange weights that are on the wrong side; return whether none is left."""
    fewest, rounds = len(linear) + 1, _ROUNDS
    for _ in range(most):
        _free_ones(squares, linear, work)
        wrong = _mark(squares, work, length)
        if wrong == 0:
            return True
        rounds = _ROUNDS if wrong < fewest else rounds - 1
        fewest = min(fewest, wrong)
        if rounds < 0:
            _mark_the_last_only(work)
        _factorize(squares.gram, work, _swap(squares, work))
    return False


@inner("work")
def _free_ones(squares: Squares, linear: Floats, work: Work) -> None:
    """Write the free weights, whether beyond the bounds or not, and the gradient."""
    size, weights, slope = work.size[0], work.weights, work.slope
    for k in range(len(slope)):
        slope[k] = -linear[k]
    for j in range(len(weights)):
        if work.place[j] != FREE and weights[j] != 0.0:
            _add(slope, squares.gram[j], weights[j], len(slope))
    for k in range(size):
        work.ahead[k] = -slope[work.order[k]]
    _solve(work)
    for k in range(size):
        weights[work.order[k]] = work.ahead[k]
        _add(slope, squares.gram[work.order[k]], work.ahead[k], len(slope))


@inner("work")
def _mark(squares: Squares, work: Work, length: float) -> int:
    """Mark the weights that are on the wrong side, and return how many."""
    count = 0
    for j in range(len(work.weights)):
        if work.place[j] == FREE:
            work.wrong[j] = not squares.low <= work.weights[j] <= squares.high
        else:
            pull = -work.slope[j] if work.place[j] == AT_LOW else work.slope[j]
            work.wrong[j] = pull > PULL * length * squares.lengths[j]
        count += work.wrong[j]
    return count


@inner("work")
def _mark_the_last_only(work: Work) -> None:
    last = 0
    for j in range(len(work.wrong)):
        if work.wrong[j]:
            last = j
            work.wrong[j] = False
    work.wrong[last] = True


@inner("work")
def _swap(squares: Squares, work: Work) -> int:
    """Exchange the marked weights, and return from which row on the factor is another."""
    order, kept = work.order, 0
    same: int = work.size[0]
    for k in range(work.size[0]):
        i = order[k]
        if work.wrong[i]:
            above = work.weights[i] > squares.high
            work.place[i] = AT_HIGH if above else AT_LOW
            work.weights[i] = squares.high if above else squares.low
            work.wrong[i] = False
            same = min(same, k)
        else:
            order[kept] = i
            kept += 1
    for j in range(len(work.wrong)):
        if work.wrong[j]:
            work.place[j] = FREE
            order[kept] = j
            kept += 1
    work.size[0] = kept
    return same


@inner("rest", "work")
def _refine(squares: Squares, target: Floats, before: Floats, rest: Floats, work: Work) -> None:
    """Take from the free weights what the normal equations have cost in accuracy."""
    _copy(rest, target)
    for j in range(len(work.weights)):
        if work.weights[j] != 0.0:
            _add(rest, squares.columns[j], -work.weights[j], len(rest))
    for k in range(work.size[0]):
        i = work.order[k]
        step = squares.ridge * (work.weights[i] - before[i])
        work.ahead[k] = _dot(squares.columns[i], rest, len(rest)) - step
    _solve(work)
    for k in range(work.size[0]):
        i = work.order[k]
        work.weights[i] = min(max(work.weights[i] + work.ahead[k], squares.low), squares.high)
