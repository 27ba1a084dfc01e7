"""Smoothing splines and their generalised cross-validation, compiled: import when it runs.

The natural cubic smoothing spline of samples one frame apart, by Reinsch's equations: with
second differences ``Q'y`` and R tridiagonal (2/3 on the diagonal, 1/6 beside it),
``(R + lambda Q'Q) c = Q'y`` and the spline at the samples is ``y - lambda Q c``. The matrix has
five bands that do not change along it, and is split into ``L D L'``.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

inlined = partial(kernel, forceinline=True, no_cpython_wrapper=True)

LEAST, MOST = 1e-4, 1e10
"""Between which lambda is looked for: goes through the samples; the limit of what is accurate."""

PER_DECADE = 3
NARROWINGS = 30
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@inlined("diagonal", "first", "second")
def _split(penalty: float, diagonal: Floats, first: Floats, second: Floats) -> None:
    """Write D and the bands of L: ``first[i]``, ``second[i]`` are ``L[i+1, i]``, ``L[i+2, i]``."""
    middle, beside, apart = 2.0 / 3.0 + 6.0 * penalty, 1.0 / 6.0 - 4.0 * penalty, penalty
    for i in range(len(diagonal)):
        value, next_to = middle, beside
        if i > 0:
            value -= first[i - 1] * first[i - 1] * diagonal[i - 1]
            next_to -= second[i - 1] * first[i - 1] * diagonal[i - 1]
        if i > 1:
            value -= second[i - 2] * second[i - 2] * diagonal[i - 2]
        diagonal[i], first[i], second[i] = value, next_to / value, apart / value


@kernel()
def freedom(length: int, penalty: float) -> float:
    """Return the trace of I - A, where A y is the spline at the samples y.

    It is ``lambda trace(Q'Q B)``, B being the inverse of the matrix, of which five bands are
    enough (Hutchinson & de Hoog, 1985).
    """
    diagonal, first, second = np.empty(length - 2), np.empty(length - 2), np.empty(length - 2)
    _split(penalty, diagonal, first, second)
    total = far = later = near_later = 0.0
    for i in range(length - 3, -1, -1):
        # later: B[i+1, i+1]; near_later: B[i+1, i+2]; far: B[i+2, i+2]
        beside = -first[i] * later - second[i] * near_later
        apart = -first[i] * near_later - second[i] * far
        own = 1.0 / diagonal[i] - first[i] * beside - second[i] * apart
        total += 6.0 * own - 8.0 * beside + 2.0 * apart
        far, later, near_later = later, own, beside
    return penalty * total


@kernel("curve")
def spline(values: Floats, penalty: float, curve: Floats) -> float:
    """Write the spline at the samples, and return the sum of its squared residuals.

    Parameters
    ----------
    values, curve : (T, K) arrays of float64
        T at least 3; K coordinates.
    penalty
        lambda.
    """
    length, axes = values.shape
    size = length - 2
    diagonal, first, second = np.empty(size), np.empty(size), np.empty(size)
    _split(penalty, diagonal, first, second)
    bend, residuals = np.empty(size), 0.0
    for axis in range(axes):
        for i in range(size):
            bend[i] = values[i, axis] - 2.0 * values[i + 1, axis] + values[i + 2, axis]
        _solve(bend, diagonal, first, second)
        for i in range(length):
            change = 0.0
            if i < size:
                change += bend[i]
            if 0 < i <= size:
                change -= 2.0 * bend[i - 1]
            if i > 1:
                change += bend[i - 2]
            residuals += (penalty * change) ** 2
            curve[i, axis] = values[i, axis] - penalty * change
    return residuals


@inlined("right")
def _solve(right: Floats, diagonal: Floats, first: Floats, second: Floats) -> None:
    """Replace a right-hand side by the solution, the matrix being split."""
    size = len(right)
    for i in range(1, size):
        right[i] -= first[i - 1] * right[i - 1]
        if i > 1:
            right[i] -= second[i - 2] * right[i - 2]
    for i in range(size - 1, -1, -1):
        right[i] /= diagonal[i]
        if i + 1 < size:
            right[i] -= first[i] * right[i + 1]
        if i + 2 < size:
            right[i] -= second[i] * right[i + 2]


@kernel("curve")
def criterion(values: Floats, penalty: float, curve: Floats) -> float:
    """Return ``T sum(residuals^2) / trace(I - A)^2``, and write the spline."""
    left: float = freedom(len(values), penalty)
    residuals: float = spline(values, penalty, curve)
    return len(values) * residuals / (left * left)


@kernel()
def smooth(values: Floats) -> tuple[Floats, Floats]:
    """Return the smoothing splines of runs of one length, each with the best lambda of its own.

    lambda is looked for on a grid and then, around the best of it, by golden section; between
    `LEAST` and the fourth power of the length, or `MOST`.

    Parameters
    ----------
    values : (T, R, 3) array of float64
        The three coordinates of a run share one lambda.

    Returns
    -------
    curves : (T, R, 3) array of float64
    penalties : (R,) array of float64
        Each run's lambda.
    """
    length, runs = values.shape[:2]
    curves, penalties = np.empty_like(values), np.empty(runs)
    low, high = math.log(LEAST), math.log(min(float(length) ** 4, MOST))
    count = 2 + int((high - low) / math.log(10.0) * PER_DECADE)
    step = (high - low) / (count - 1)
    left = np.empty(count)
    for k in range(count):
        left[k] = freedom(length, math.exp(low + k * step))
    for run in range(runs):
        track, fitted = values[:, run].copy(), np.empty((length, 3))
        best, least = 0, np.inf
        for k in range(count):
            value = spline(track, math.exp(low + k * step), fitted) / (left[k] * left[k])
            if value < least:
                best, least = k, value
        begin, end = low + max(best - 1, 0) * step, low + min(best + 1, count - 1) * step
        penalties[run] = math.exp(_narrow(track, begin, end, fitted))
        spline(track, penalties[run], fitted)
        for t in range(length):
            for axis in range(3):
                curves[t, run, axis] = fitted[t, axis]
    return curves, penalties


@inlined("fitted")
def _narrow(values: Floats, begin: float, end: float, fitted: Floats) -> float:
    """Return the logarithm of the best lambda between two, by golden section."""
    first, second = end - _GOLDEN * (end - begin), begin + _GOLDEN * (end - begin)
    at_first = criterion(values, math.exp(first), fitted)
    at_second = criterion(values, math.exp(second), fitted)
    for _ in range(NARROWINGS):
        if at_first <= at_second:
            end, second, at_second = second, first, at_first
            first = end - _GOLDEN * (end - begin)
            at_first = criterion(values, math.exp(first), fitted)
        else:
            begin, first, at_first = first, second, at_second
            second = begin + _GOLDEN * (end - begin)
            at_second = criterion(values, math.exp(second), fitted)
    return 0.5 * (begin + end)
