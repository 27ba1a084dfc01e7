"""The loop over frames of the low-rank fills, compiled: import this module only when one runs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel(fastmath={"reassoc", "contract"})


@compiled
def complete(rows: Any, missing: Any, precision: Any) -> None:
    """Write into each row x the missing entries that make ``x' K x`` least.

    They are ``- inv(K_mm) K_mo x_o``, m standing for the missing and o for the other entries:
    the conditional mean, if x is normal with mean 0 and covariance inv(K).

    Parameters
    ----------
    rows : (N, P) array of float64
        Written where missing.
    missing : (N, P) array of bool
    precision : (P, P) array of float64
        K, positive definite.
    """
    count, width = rows.shape
    factor, places, solution = np.empty((width, width)), np.empty(width, np.int64), np.empty(width)
    size = 0
    for row in range(count):
        # neighbouring rows mostly lack the same: the factor serves for all of them
        if row == 0 or not np.array_equal(missing[row], missing[row - 1]):
            size = 0
            for column in range(width):
                if missing[row, column]:
                    places[size] = column
                    size += 1
            _factorize(precision, places[:size], factor)
        _solve(precision, places[:size], factor, rows[row], solution)


@compiled
def _factorize(precision: Any, places: Any, factor: Any) -> None:
    """Write Cholesky's factor of ``K_mm``, m being the places."""
    for i in range(len(places)):
        line = precision[places[i]]
        for j in range(i + 1):
            rest = line[places[j]]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            factor[i, j] = math.sqrt(rest) if i == j else rest / factor[j, j]


@compiled
def _solve(precision: Any, places: Any, factor: Any, row: Any, solution: Any) -> None:
    size = len(places)
    for i in range(size):
        row[places[i]] = 0.0
    for i in range(size):
        line, rest = precision[places[i]], 0.0
        for column in range(len(row)):
            rest -= line[column] * row[column]
        for k in range(i):
            rest -= factor[i, k] * solution[k]
        solution[i] = rest / factor[i, i]
    for i in range(size - 1, -1, -1):
        rest = solution[i]
        for k in range(i + 1, size):
            rest -= factor[k, i] * solution[k]
        solution[i] = rest / factor[i, i]
        row[places[i]] = solution[i]
