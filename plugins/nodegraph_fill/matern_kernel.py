"""The loops of Gaussian processes over time, compiled: import this module only when it runs.

Written out entry by entry: what numba makes of expressions of arrays takes long to compile.
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

compiled = partial(kernel, fastmath={"reassoc", "contract"})
inner = partial(compiled, no_cpython_wrapper=True)  # for kernels only

_STEADY = 1e-6
"""Change of the variance of a prediction, relative to that of the sample, that is none."""
_LENGTHS, _NOISES = (0.0, 6.0), (-18.0, 5.0)
"""Logarithms between which the length, in frames, and the noise, relative, are sought."""
_STEPS = (0.8, 2.0, 0.15)
"""First steps of both logarithms, and the step of the first at which the search ends."""


@inner("moves", "drift", "still")
def _set_process(length: float, moves: Floats, drift: Floats, still: Floats) -> None:
    """Write transition, covariance of its noise and stationary covariance, (3, 3) each.

    The state is a process of variance 1 and its first two derivatives, by powers of
    ``sqrt(5) / length`` per frame.
    """
    s = np.sqrt(5.0) / length
    half, decay = 0.5 * s * s, np.exp(-s)
    moves[0, 0] = decay * (1.0 + s + half)
    moves[0, 1] = decay * (s + s * s)
    moves[0, 2] = decay * half
    moves[1, 0] = -decay * half
    moves[1, 1] = decay * (1.0 + s - s * s)
    moves[1, 2] = decay * (s - half)
    moves[2, 0] = decay * (half - s)
    moves[2, 1] = decay * (s * s - 3.0 * s)
    moves[2, 2] = decay * (1.0 - 2.0 * s + half)
    for i in range(3):
        for j in range(3):
            still[i, j] = 0.0
    still[0, 0] = still[2, 2] = 1.0
    still[1, 1] = 1.0 / 3.0
    still[0, 2] = still[2, 0] = -1.0 / 3.0
    for i in range(3):
        for j in range(3):
            drift[i, j] = still[i, j]
    _turn(moves, moves, still)
    for i in range(3):
        for j in range(3):
            drift[i, j], still[i, j] = drift[i, j] - still[i, j], drift[i, j]


@inner("matrix")
def _turn(left: Floats, right: Floats, matrix: Floats) -> None:
    """Replace S by ``L S R'``, (3, 3) each."""
    for j in range(3):
        x, y, z = matrix[0, j], matrix[1, j], matrix[2, j]
        for i in range(3):
            matrix[i, j] = left[i, 0] * x + left[i, 1] * y + left[i, 2] * z
    for i in range(3):
        x, y, z = matrix[i, 0], matrix[i, 1], matrix[i, 2]
        for j in range(3):
            matrix[i, j] = right[j, 0] * x + right[j, 1] * y + right[j, 2] * z


@inner("moves", "gains")
def _set_gains(seen: Flags, length: float, noise: float, moves: Floats, gains: Floats) -> float:
    """Write how the next state follows from the error of predicting a sample.

    By frame, ``gains[t, :3]`` times the error is added to the moved state. ``gains[t, 3]`` is one
    over the error's deviation. Both are 0 where not seen. Returned is the sum of the logarithms
    of the errors' variances.
    """
    drift, covariance = np.empty((3, 3)), np.empty((3, 3))
    _set_process(length, moves, drift, covariance)
    x = y = z = weight = logarithm = total = 0.0
    variance, steady = 1.0, False
    for t in range(len(seen)):
        if not seen[t]:
            x = y = z = weight = 0.0
            steady = False
        elif not steady:
            a, b, c = covariance[0, 0], covariance[1, 0], covariance[2, 0]
            variance = a + noise
            weight, logarithm = 1.0 / np.sqrt(variance), np.log(variance)
            for i in range(3):
                along = covariance[i, 0] / variance
                covariance[i, 0] -= along * a
                covariance[i, 1] -= along * b
                covariance[i, 2] -= along * c
            x = (moves[0, 0] * a + moves[0, 1] * b + moves[0, 2] * c) / variance
            y = (moves[1, 0] * a + moves[1, 1] * b + moves[1, 2] * c) / variance
            z = (moves[2, 0] * a + moves[2, 1] * b + moves[2, 2] * c) / variance
        if seen[t]:
            total += logarithm
        gains[t, 0], gains[t, 1], gains[t, 2], gains[t, 3] = x, y, z, weight
        if not steady:
            _turn(moves, moves, covariance)
            for i in range(3):
                for j in range(3):
                    covariance[i, j] += drift[i, j]
            steady = seen[t] and abs(covariance[0, 0] + noise - variance) <= _STEADY * variance
    return total


@inner()
def _predict(
    moves: Floats, gain: Floats, value: float, x: float, y: float, z: float
) -> tuple[float, float, float, float]:
    """Return the error of predicting a value from the state, and the next state."""
    error = value - x
    return (
        error,
        moves[0, 0] * x + moves[0, 1] * y + moves[0, 2] * z + gain[0] * error,
        moves[1, 0] * x + moves[1, 1] * y + moves[1, 2] * z + gain[1] * error,
        moves[2, 0] * x + moves[2, 1] * y + moves[2, 2] * z + gain[2] * error,
    )


@compiled("rows")
def whiten(rows: Floats, seen: Flags, length: float, noise: float) -> float:
    """Turn rows, (T, C), into errors of prediction over their deviations, 0 where not seen.

    Returns
    -------
    float
        The sum of the logarithms of the variances of the predictions.
    """
    moves, gains = np.empty((3, 3)), np.empty((len(rows), 4))
    total = _set_gains(seen, length, noise, moves, gains)
    for c in range(rows.shape[1]):
        x = y = z = 0.0
        for t in range(len(rows)):
            error, x, y, z = _predict(moves, gains[t], rows[t, c], x, y, z)
            rows[t, c] = gains[t, 3] * error
    return total


@inner("gains")
def _deviance(
    rows: Floats, seen: Flags, length: float, noise: float, gains: Floats
) -> tuple[float, float]:
    """Return twice the negative log likelihood at the best variance, and that variance."""
    moves = np.empty((3, 3))
    total = 3.0 * _set_gains(seen, length, noise, moves, gains)
    x = y = z = u = v = w = r = s = q = 0.0
    count, square = 0, 0.0
    for t in range(len(rows)):
        first, x, y, z = _predict(moves, gains[t], rows[t, 0], x, y, z)
        second, u, v, w = _predict(moves, gains[t], rows[t, 1], u, v, w)
        third, r, s, q = _predict(moves, gains[t], rows[t, 2], r, s, q)
        errors = first * first + second * second + third * third
        square += gains[t, 3] * gains[t, 3] * errors
        count += 3 * seen[t]
    count = max(count, 3)
    variance = max(square / count, 1e-300)
    return total + count * np.log(variance), variance


@compiled()
def fit(rows: Floats, seen: Flags, length: float, noise: float) -> tuple[float, float, float]:
    """Return the length, the noise relative to the variance, and the variance most likely.

    From those given, both logarithms step to the best of the four neighbours, by half as much
    where none is better.
    """
    gains = np.empty((len(rows), 4))
    x, y = np.log(length), np.log(noise)
    least, variance = _deviance(rows, seen, length, noise, gains)
    across, along, end = _STEPS
    while across > end:
        best_x, best_y, before = x, y, least
        for turn in range(4):
            a = x + (across if turn == 0 else -across if turn == 1 else 0.0)
            b = y + (along if turn == 2 else -along if turn == 3 else 0.0)
            if _LENGTHS[0] <= a <= _LENGTHS[1] and _NOISES[0] <= b <= _NOISES[1]:
                value, square = _deviance(rows, seen, np.exp(a), np.exp(b), gains)
                if value < least:
                    least, variance, best_x, best_y = value, square, a, b
        x, y = best_x, best_y
        if not least < before:
            across, along = across / 2.0, along / 2.0
    return np.exp(x), np.exp(y), variance


@compiled()
def smooth(
    lengths: Floats,
    variances: Floats,
    noises: Floats,
    values: Floats,
    seen: Flags,
    first: int,
    last: int,
) -> tuple[Floats, Floats]:
    """Return mean, (F, 3), and variance, (F,), of a sum of processes in some frames.

    Channel c observes the sum of the first c + 1 processes, so that the last one observes what is
    wanted. The covariances are the same for the three coordinates. Forward a Kalman filter,
    backward the smoother of Bryson and Frazier, which inverts nothing.

    Parameters
    ----------
    lengths, variances
        Lengths and variances of the processes, (C,).
    noises
        The variances of the channels' noise, (C,).
    values, seen
        Observations, (T, C, 3), and where there are any, (T, C).
    first, last
        Frames ``first`` to ``last - 1`` are wanted.
    """
    frames, count = len(values), len(lengths)
    moves, back = np.empty((count, 3, 3)), np.empty((count, 3, 3))
    drift, covariance = np.empty((count, 3, 3)), np.zeros((count, count, 3, 3))
    for c in range(count):
        _set_process(lengths[c], moves[c], drift[c], covariance[c, c])
        _scale(variances[c], moves[c], back[c], drift[c], covariance[c, c])
    states, covariances = np.empty((last, count, 3, 3)), np.empty((last, count, count, 3, 3))
    gains, errors = np.empty((frames, count, count, 3)), np.empty((frames, count, 3))
    weights = np.zeros((frames, count))
    state, pull = np.zeros((count, 3, 3)), np.zeros((count, 3, 3))
    precision = np.zeros((count, count, 3, 3))
    for t in range(frames):
        if first <= t < last:
            _copy(state, covariance, states[t], covariances[t])
        for c in range(count):
            if seen[t, c]:
                gain, error = gains[t, c], errors[t, c]
                weights[t, c] = _observe(c, noises[c], values[t, c], state, covariance, gain, error)
        _move(moves, state, covariance)
        _add(covariance, drift)
    mean, variance = np.empty((last - first, 3)), np.empty(last - first)
    for t in range(frames - 1, first - 1, -1):
        _move(back, pull, precision)
        for c in range(count - 1, -1, -1):
            if seen[t, c]:
                _look_back(c, gains[t, c], errors[t, c], weights[t, c], pull, precision)
        if t < last:
            place = t - first
            variance[place] = _known(states[t], covariances[t], pull, precision, mean[place])
    return mean, variance


@inner("back", "drift", "still")
def _scale(variance: float, moves: Floats, back: Floats, drift: Floats, still: Floats) -> None:
    """Give a process its variance, and transpose its transition."""
    for i in range(3):
        for j in range(3):
            back[j, i] = moves[i, j]
            drift[i, j] *= variance
            still[i, j] *= variance


@inner("states", "covariances")
def _copy(state: Floats, covariance: Floats, states: Floats, covariances: Floats) -> None:
    for c in range(len(state)):
        for i in range(3):
            for k in range(3):
                states[c, i, k] = state[c, i, k]
        for d in range(len(state)):
            for i in range(3):
                for j in range(3):
                    covariances[c, d, i, j] = covariance[c, d, i, j]


@inner("state", "covariance")
def _move(moves: Floats, state: Floats, covariance: Floats) -> None:
    """Replace states s, as columns, by ``M s`` and a matrix S by ``M S M'``, block by block."""
    for c in range(len(moves)):
        for k in range(3):
            x, y, z = state[c, 0, k], state[c, 1, k], state[c, 2, k]
            for i in range(3):
                state[c, i, k] = moves[c, i, 0] * x + moves[c, i, 1] * y + moves[c, i, 2] * z
        for d in range(len(moves)):
            _turn(moves[c], moves[d], covariance[c, d])


@inner("covariance")
def _add(covariance: Floats, drift: Floats) -> None:
    """Add to the blocks of the diagonal."""
    for c in range(len(drift)):
        for i in range(3):
            for j in range(3):
                covariance[c, c, i, j] += drift[c, i, j]


@inner("matrix")
def _add_outer(matrix: Floats, column: Floats, row: Floats, factor: float) -> None:
    """Add the product of a column and a row times a factor, (3, 3)."""
    for i in range(3):
        along = factor * column[i]
        for j in range(3):
            matrix[i, j] += along * row[j]


@inner("product")
def _times(matrix: Floats, column: Floats, product: Floats) -> None:
    """Add ``M v`` to a product, M being made of blocks."""
    for c in range(len(matrix)):
        for d in range(len(matrix)):
            for i in range(3):
                for j in range(3):
                    product[c, i] += matrix[c, d, i, j] * column[d, j]


@inner("state", "covariance", "gain", "error")
def _observe(
    channel: int,
    noise: float,
    value: Floats,
    state: Floats,
    covariance: Floats,
    gain: Floats,
    error: Floats,
) -> float:
    """Add an observation; return one over its variance, and write gain and error by this."""
    _set_along(covariance, channel, gain)
    variance = noise
    for c in range(channel + 1):
        variance += gain[c, 0]
    weight = 1.0 / variance
    for k in range(3):
        error[k] = weight * value[k]
        for c in range(channel + 1):
            error[k] -= weight * state[c, 0, k]
    for c in range(len(state)):
        _add_outer(state[c], gain[c], error, 1.0)
        for d in range(len(state)):
            _add_outer(covariance[c, d], gain[c], gain[d], -weight)
    for c in range(len(state)):
        for i in range(3):
            gain[c, i] *= weight
    return weight


@inner("along")
def _set_along(covariance: Floats, channel: int, along: Floats) -> None:
    """Write the covariance of the state with what a channel observes."""
    for c in range(len(covariance)):
        for i in range(3):
            along[c, i] = 0.0
            for d in range(channel + 1):
                along[c, i] += covariance[c, d, i, 0]


@inner("error", "pull", "precision")
def _look_back(
    channel: int, gain: Floats, error: Floats, weight: float, pull: Floats, precision: Floats
) -> None:
    """Take an observation into what later ones tell of the state before."""
    count = len(pull)
    along = np.zeros((count, 3))
    _times(precision, gain, along)
    for c in range(count):
        for i in range(3):
            weight += gain[c, i] * along[c, i]
            for k in range(3):
                error[k] -= gain[c, i] * pull[c, i, k]
    for c in range(channel + 1):
        for k in range(3):
            pull[c, 0, k] += error[k]
        for d in range(count):
            for i in range(3):
                precision[c, d, 0, i] -= along[d, i]
                precision[d, c, i, 0] -= along[d, i]
        for d in range(channel + 1):
            precision[c, d, 0, 0] += weight


@inner("mean")
def _known(
    state: Floats, covariance: Floats, pull: Floats, precision: Floats, mean: Floats
) -> float:
    """Write the mean of the sum, all observations being known, and return its variance."""
    count, variance = len(state), 0.0
    along, turned = np.empty((count, 3)), np.zeros((count, 3))
    _set_along(covariance, count - 1, along)
    _times(precision, along, turned)
    for k in range(3):
        mean[k] = 0.0
        for c in range(count):
            mean[k] += state[c, 0, k]
            for i in range(3):
                mean[k] += along[c, i] * pull[c, i, k]
    for c in range(count):
        variance += along[c, 0]
        for i in range(3):
            variance -= along[c, i] * turned[c, i]
    return max(variance, 0.0)
