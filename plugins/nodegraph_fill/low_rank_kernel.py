"""The loops over missing entries of the low-rank fills, compiled: import only when one runs."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = partial(kernel, fastmath={"reassoc", "contract"})
inner = partial(compiled, no_cpython_wrapper=True)  # for kernels only


@compiled()
def factorize(start: Integers, columns: Integers, precision: Floats) -> tuple[Floats, Integers]:
    """Return Cholesky's factors of ``K_mm`` row by row, m being the row's missing entries.

    Parameters
    ----------
    start : (N + 1,) array of int
        Where each row's entries begin among all, and their number.
    columns : (E,) array of int
    precision : (P, P) array of float64
        K, positive definite.

    Returns
    -------
    factors : (S,) array of float64
        Lower triangles one after the other, by rows, their diagonals inverted.
    where : (N,) array of int
        Where the triangle of each row begins.
    """
    where = np.zeros(len(start) - 1, np.int64)
    size, before = 0, columns[:0]
    for row in range(len(where)):
        places = columns[start[row] : start[row + 1]]
        # neighbouring rows mostly lack the same: the factor serves for all of them
        if row and _equal(places, before):
            where[row] = where[row - 1]
        else:
            where[row] = size
            size += len(places) * (len(places) + 1) // 2
        before = places
    factors, end = np.empty(size), 0
    for row in range(len(where)):
        if where[row] == end:
            places = columns[start[row] : start[row + 1]]
            _factorize(precision, places, factors[end:])
            end += len(places) * (len(places) + 1) // 2
    return factors, where


@inner()
def _equal(places: Integers, others: Integers) -> bool:
    equal = len(places) == len(others)
    if equal:
        for i in range(len(places)):
            equal &= places[i] == others[i]
    return equal


@inner("factor")
def _factorize(precision: Floats, places: Integers, factor: Floats) -> None:
    for i in range(len(places)):
        line, first = precision[places[i]], i * (i + 1) // 2
        for j in range(i + 1):
            rest, other = line[places[j]], j * (j + 1) // 2
            for k in range(j):
                rest -= factor[first + k] * factor[other + k]
            diagonal = factor[other + j]
            factor[first + j] = 1.0 / math.sqrt(rest) if i == j else rest * diagonal


@compiled()
def solve(start: Integers, factors: Floats, where: Integers, values: Floats) -> Floats:
    """Return ``inv(K_mm) v`` row by row, from the factors of all K_mm and v, (E,)."""
    solution = np.empty_like(values)
    for row in range(len(where)):
        entries = slice(start[row], start[row + 1])
        _solve(factors[where[row] :], values[entries], solution[entries])
    return solution


@inner("solution")
def _solve(factor: Floats, values: Floats, solution: Floats) -> None:
    size = len(values)
    for i in range(size):
        rest, first = values[i], i * (i + 1) // 2
        for k in range(i):
            rest -= factor[first + k] * solution[k]
        solution[i] = rest * factor[first + i]
    for i in range(size - 1, -1, -1):
        first = i * (i + 1) // 2
        solution[i] *= factor[first + i]
        for k in range(i):
            solution[k] -= factor[first + k] * solution[i]


@compiled()
def inverses(
    start: Integers, columns: Integers, factors: Floats, where: Integers, size: int
) -> Floats:
    """Return the sum over the rows of ``inv(K_mm)``, at m, (size, size), from the factors."""
    total, inverse = np.zeros((size, size)), np.empty((0, 0))
    for row in range(len(where)):
        places = columns[start[row] : start[row + 1]]
        if not row or where[row] != where[row - 1]:
            inverse = np.empty((len(places), len(places)))
            for i in range(len(places)):
                unit = np.zeros(len(places))
                unit[i] = 1.0
                _solve(factors[where[row] :], unit, inverse[i])
        for i in range(len(places)):
            for j in range(len(places)):
                total[places[i], places[j]] += inverse[i, j]
    return total


@compiled()
def gather(
    sources: Integers,
    targets: Integers,
    values: NDArray[np.floating],
    lines: NDArray[np.floating],
    size: int,
) -> NDArray[np.floating]:
    """Return `size` lines, each the sum of value times source line over what has it as target.

    Parameters
    ----------
    sources, targets : (E,) arrays of int
    values : (E,) array of float64
    lines : (N, P) array of float64
    size : int
    """
    gathered = np.zeros((size, lines.shape[1]), lines.dtype)
    for entry in range(len(values)):
        target, source, value = gathered[targets[entry]], lines[sources[entry]], values[entry]
        for k in range(len(target)):
            target[k] += value * source[k]
    return gathered


@compiled()
def product(
    rows: Integers, columns: Integers, scores: NDArray[np.floating], matrix: NDArray[np.floating]
) -> NDArray[np.floating]:
    """Return the entries of ``Y D'``, Y being the scores, (N, K), and D the matrix, (P, K)."""
    entries, zero = np.empty(len(rows), scores.dtype), scores.dtype.type(0)
    for entry in range(len(rows)):
        line, score, value = matrix[columns[entry]], scores[rows[entry]], zero
        for k in range(len(score)):
            value += line[k] * score[k]
        entries[entry] = value
    return entries
