"""The least of many weights that are as good, compiled: import this module only when one runs.

Of all weights w within bounds that have the same ``projector' w``, those of the least norm are
``projector y``, clipped to the bounds, for some y. It is found by the proximal point method
(Rockafellar, 1976): y maximizes the dual, which is concave and piecewise quadratic, less
``share |y - centre|^2 / 2``, by Newton's method with steps halved until they climb; then that y is
the centre, until nothing is left of the difference. With a smaller share where that takes long.
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

compiled = kernel(error_model="numpy")

SHARES = (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)
ENOUGH = 5e-12
"""Up to this share of it, ``projector' w`` is as it was."""

_EXACT, _NOTHING = 1e-13, 1e-13
_CENTRES, _STAYS, _STEPS, _HALVINGS, _SHARPER = 20, 3, 20, 30, 5


class Ties(NamedTuple):
    """Penalties on the weights.

    Attributes
    ----------
    projector : (K, R) array of float64
        Its columns are orthonormal.
    wanted : (R,) array of float64
        What ``projector' w`` is to be; that of some weights within the bounds.
    low, high : (K,) arrays of float64
    """

    projector: Floats
    wanted: Floats
    low: Floats
    high: Floats


@compiled
def share(
    projector: Floats, wanted: Floats, lows: Floats, highs: Floats, shared: Floats, solved: Flags
) -> None:
    """Write the weights of least norm with each ``projector' w``.

    Parameters
    ----------
    projector : (K, R) array of float64
    wanted : (N, R) array of float64
    lows, highs : (N, K) arrays of float64
    shared : (N, K) array of float64
        Written.
    solved : (N,) array of bool
        Written: whether they could be determined. Where not, the weights are not valid.
    """
    for frame in range(len(wanted)):
        ties = Ties(projector, wanted[frame], lows[frame], highs[frame])
        size = math.sqrt((ties.wanted * ties.wanted).sum())
        _share(ties, size, shared[frame])
        solved[frame] = _sharpen(ties, shared[frame]) <= ENOUGH * size


@compiled
def _share(ties: Ties, size: float, shared: Floats) -> None:
    """Write the weights that come nearest to what is wanted."""
    count = len(ties.wanted)
    point, slope, weights = ties.wanted.copy(), np.empty(count), np.empty(len(shared))
    best = np.inf
    for smaller in SHARES:
        least, stays = np.inf, 0
        for _ in range(_CENTRES):
            _dual(ties, 0.0, point, point, weights, slope)
            apart = _largest(slope)
            if apart < best:
                best = apart
                shared[:] = weights
            stays = 0 if apart < 0.9 * least else stays + 1
            least = min(least, apart)
            if best <= _EXACT * size or stays == _STAYS:
                break
            _climb(ties, smaller, point)
        if best <= ENOUGH * size:
            break


@compiled
def _climb(ties: Ties, share: float, point: Floats) -> None:
    """Go to the y of the largest dual less ``share |y - centre|^2 / 2``, the centre being here."""
    count = len(point)
    centre, there, slope = point.copy(), np.empty(count), np.empty(count)
    weights = np.empty(len(ties.low))
    value = _dual(ties, share, centre, point, weights, slope)
    for _ in range(_STEPS):
        step = slope.copy()
        _solve(_curvature(ties, weights, share), step)
        rise, steepest, part = (slope * step).sum(), _largest(slope), 1.0
        climbs = False
        for _ in range(_HALVINGS):
            there[:] = point + part * step
            reached = _dual(ties, share, centre, there, weights, slope)
            climbs = reached >= value + 1e-4 * part * rise or _largest(slope) < 0.5 * steepest
            if climbs:
                break
            part *= 0.5
        if not climbs:
            break
        point[:] = there
        value = reached
        if _largest(slope) <= 1e-3 * share * _largest(point - centre):
            break


@compiled
def _dual(
    ties: Ties, share: float, centre: Floats, point: Floats, weights: Floats, slope: Floats
) -> float:
    """Return its value at a point, and write the weights there and the gradient."""
    value, count = 0.0, len(point)
    for k in range(count):
        away = point[k] - centre[k]
        slope[k] = ties.wanted[k] - share * away
        value += ties.wanted[k] * point[k] - 0.5 * share * away * away
    for j in range(len(weights)):
        row, straight = ties.projector[j], 0.0
        for k in range(count):
            straight += row[k] * point[k]
        weight = min(max(straight, ties.low[j]), ties.high[j])
        for k in range(count):
            slope[k] -= row[k] * weight
        value -= straight * weight - 0.5 * weight * weight
        weights[j] = weight
    return value


@compiled
def _curvature(ties: Ties, weights: Floats, share: float) -> Floats:
    """Return the lower triangle of the second derivatives, with `share` on the diagonal."""
    count = len(ties.wanted)
    matrix = np.zeros((count, count))
    for j in range(len(weights)):
        if ties.low[j] < weights[j] < ties.high[j]:
            row = ties.projector[j]
            for i in range(count):
                for k in range(i + 1):
                    matrix[i, k] += row[i] * row[k]
    for i in range(count):
        matrix[i, i] += share
    return matrix


@compiled
def _solve(matrix: Floats, right: Floats) -> None:
    """Replace the right-hand side by the solution, the lower triangle by Cholesky's factor."""
    count = len(right)
    for i in range(count):
        for k in range(i + 1):
            entry = matrix[i, k]
            for n in range(k):
                entry -= matrix[i, n] * matrix[k, n]
            matrix[i, k] = math.sqrt(max(entry, _NOTHING**2)) if i == k else entry / matrix[k, k]
    for i in range(count):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    for i in range(count - 1, -1, -1):
        right[i] /= matrix[i, i]
        for k in range(i):
            right[k] -= matrix[i, k] * right[i]


@compiled
def _sharpen(ties: Ties, shared: Floats) -> float:
    """Move the weights that are between their bounds by what a far y has cost in accuracy.

    Returns the largest difference that is left.
    """
    apart, rest = np.inf, np.empty(len(ties.wanted))
    sharper = shared.copy()
    for _ in range(_SHARPER):
        rest[:] = ties.wanted
        for j in range(len(shared)):
            rest -= ties.projector[j] * sharper[j]
        nearer = _largest(rest)
        if nearer >= apart:
            break
        apart = nearer
        shared[:] = sharper
        _solve(_curvature(ties, shared, _NOTHING), rest)
        for j in range(len(shared)):
            if ties.low[j] < shared[j] < ties.high[j]:
                step = (ties.projector[j] * rest).sum()
                sharper[j] = min(max(shared[j] + step, ties.low[j]), ties.high[j])
    return float(apart)


@compiled
def _largest(values: Floats) -> float:
    largest = 0.0
    for k in range(len(values)):
        largest = max(largest, abs(values[k]))
    return largest
