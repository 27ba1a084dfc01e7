"""The loops over missing entries of the low-rank fills, compiled: import only when one runs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel(fastmath={"reassoc", "contract"})


@compiled
def solve(start: Any, columns: Any, precision: Any, values: Any) -> Any:
    """Return ``inv(K_mm) v`` row by row, m being the row's missing entries.

    Parameters
    ----------
    start : (N + 1,) array of int
        Where each row's entries begin among all, and their number.
    columns : (E,) array of int
    precision : (P, P) array of float64
        K, positive definite.
    values : (E,) array of float64
        v.
    """
    size = np.max(np.diff(start)) if len(start) > 1 else 0
    factor, solution = np.empty((size, size)), np.empty_like(values)
    before = columns[:0]
    for row in range(len(start) - 1):
        entries = slice(start[row], start[row + 1])
        places = columns[entries]
        # neighbouring rows mostly lack the same: the factor serves for all of them
        if not np.array_equal(places, before):
            _factorize(precision, places, factor)
        _solve(factor, values[entries], solution[entries])
        before = places
    return solution


@compiled
def _factorize(precision: Any, places: Any, factor: Any) -> None:
    """Write Cholesky's factor of ``K_mm``, m being the places; its diagonal inverted."""
    for i in range(len(places)):
        line = precision[places[i]]
        for j in range(i + 1):
            rest = line[places[j]]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            factor[i, j] = 1.0 / math.sqrt(rest) if i == j else rest * factor[j, j]


@compiled
def _solve(factor: Any, values: Any, solution: Any) -> None:
    size = len(values)
    for i in range(size):
        rest = values[i]
        for k in range(i):
            rest -= factor[i, k] * solution[k]
        solution[i] = rest * factor[i, i]
    for i in range(size - 1, -1, -1):
        solution[i] *= factor[i, i]
        for k in range(i):
            solution[k] -= factor[i, k] * solution[i]


@compiled
def product(rows: Any, columns: Any, values: Any, scores: Any) -> Any:
    """Return ``E' Y``, E having some values, (E,), and else zeros, and Y the scores, (N, P)."""
    width = scores.shape[1]
    product = np.zeros((width, width))
    for entry in range(len(values)):
        line, score, value = product[columns[entry]], scores[rows[entry]], values[entry]
        for k in range(width):
            line[k] += value * score[k]
    return product


@compiled
def curvature(
    start: Any, columns: Any, precision: Any, values: Any, scores: Any, change: Any
) -> Any:
    """Return ``E K + Y D'`` at the entries of E, D being the change, (P, P)."""
    curved = np.empty_like(values)
    for row in range(len(start) - 1):
        score, first, last = scores[row], start[row], start[row + 1]
        for entry in range(first, last):
            line, rest = change[columns[entry]], 0.0
            for k in range(len(score)):
                rest += line[k] * score[k]
            line = precision[columns[entry]]
            for other in range(first, last):
                rest += line[columns[other]] * values[other]
            curved[entry] = rest
    return curved
