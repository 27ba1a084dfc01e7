"""The loops of Gaussian processes over time, compiled: import this module only when it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    System = tuple[Floats, Floats, Floats]

compiled = kernel(fastmath={"reassoc", "contract"})
inner = kernel(fastmath={"reassoc", "contract"}, no_cpython_wrapper=True)  # for kernels only

_STEADY = 1e-6
"""Change of the variance of a prediction, relative to that of the sample, that is none."""
_LENGTHS, _NOISES = (0.0, 6.0), (-18.0, 5.0)
"""Logarithms between which the length, in frames, and the noise, relative, are sought."""
_STEPS = (0.8, 2.0, 0.15)
"""First steps of both logarithms, and the step of the first at which the search ends."""


@inner
def _congruent(left: Floats, right: Floats, matrix: Floats, half: Floats) -> None:
    """Replace a matrix M by ``L M R``, skipping what is zero in L and R."""
    size = len(left)
    half[:] = 0.0
    for i in range(size):
        for k in range(size):
            if left[i, k] != 0.0:
                for j in range(size):
                    half[i, j] += left[i, k] * matrix[k, j]
    matrix[:] = 0.0
    for k in range(size):
        for j in range(size):
            if right[k, j] != 0.0:
                for i in range(size):
                    matrix[i, j] += half[i, k] * right[k, j]


@inner
def _times(matrix: Floats, states: Floats) -> None:
    """Replace states s, as columns, by ``M s``."""
    size = len(matrix)
    column = np.empty(size)
    for k in range(states.shape[1]):
        for i in range(size):
            column[i] = 0.0
            for j in range(size):
                column[i] += matrix[i, j] * states[j, k]
        for i in range(size):
            states[i, k] = column[i]


@compiled
def transition(length: float) -> System:
    """Return transition, covariance of its noise and stationary covariance, (3, 3) each.

    The state is a process of variance 1 and its first two derivatives, by powers of
    ``sqrt(5) / length`` per frame.
    """
    s = np.sqrt(5.0) / length
    half = 0.5 * s * s
    moves = np.exp(-s) * np.array(
        [
            [1.0 + s + half, s + s * s, half],
            [-half, 1.0 + s - s * s, s - half],
            [half - s, s * s - 3.0 * s, 1.0 - 2.0 * s + half],
        ]
    )
    still = np.array([[1.0, 0.0, -1.0 / 3.0], [0.0, 1.0 / 3.0, 0.0], [-1.0 / 3.0, 0.0, 1.0]])
    moved = still.copy()
    _congruent(moves, np.ascontiguousarray(moves.T), moved, np.empty((3, 3)))
    return moves, still - moved, still


@compiled
def whiten(rows: Floats, seen: Flags, length: float, noise: float) -> float:
    """Turn rows, (T, C), into errors of prediction over their deviations, 0 where not seen.

    Returns
    -------
    float
        The sum of the logarithms of the variances of the predictions.
    """
    moves, drift, covariance = transition(length)
    back, half = np.ascontiguousarray(moves.T), np.empty((3, 3))
    state, gain = np.zeros((3, rows.shape[1])), np.zeros(3)
    variance, weight, total, steady = 1.0, 0.0, 0.0, False
    for t in range(len(rows)):
        if not seen[t]:
            gain[:], weight, steady = 0.0, 0.0, False
        elif not steady:
            variance = covariance[0, 0] + noise
            gain[:], weight = covariance[:, 0] / variance, 1.0 / np.sqrt(variance)
            for i in range(3):
                for j in range(3):
                    covariance[i, j] -= gain[i] * gain[j] * variance
        if seen[t]:
            total += np.log(variance)
        _predict(moves, gain, weight, state, rows[t])
        if not steady:
            _congruent(moves, back, covariance, half)
            covariance += drift
            steady = seen[t] and abs(covariance[0, 0] + noise - variance) <= _STEADY * variance
    return total


@inner
def _predict(moves: Floats, gain: Floats, weight: float, state: Floats, row: Floats) -> None:
    """Add a row to the states, replace it by its weighted errors, and go on to the next frame."""
    for c in range(len(row)):
        error = row[c] - state[0, c]
        row[c] = weight * error
        x, y, z = state[0, c], state[1, c], state[2, c]
        x, y, z = x + gain[0] * error, y + gain[1] * error, z + gain[2] * error
        state[0, c] = moves[0, 0] * x + moves[0, 1] * y + moves[0, 2] * z
        state[1, c] = moves[1, 0] * x + moves[1, 1] * y + moves[1, 2] * z
        state[2, c] = moves[2, 0] * x + moves[2, 1] * y + moves[2, 2] * z


@inner
def deviance(rows: Floats, seen: Flags, length: float, noise: float) -> tuple[float, float]:
    """Return twice the negative log likelihood at the best variance, and that variance."""
    errors = rows.copy()
    total = whiten(errors, seen, length, noise)
    count = max(np.sum(seen), 1) * rows.shape[1]
    variance = max(np.sum(errors**2) / count, 1e-300)
    return count * np.log(variance) + rows.shape[1] * total, variance


@compiled
def fit(rows: Floats, seen: Flags, length: float, noise: float) -> tuple[float, float, float]:
    """Return the length, the noise relative to the variance, and the variance most likely.

    From those given, both logarithms step to the best of the four neighbours, by half as much
    where none is better.
    """
    x, y = np.log(length), np.log(noise)
    least, variance = deviance(rows, seen, length, noise)
    across, along, end = _STEPS
    while across > end:
        best_x, best_y, before = x, y, least
        for turn in range(4):
            a = x + (across if turn == 0 else -across if turn == 1 else 0.0)
            b = y + (along if turn == 2 else -along if turn == 3 else 0.0)
            if _LENGTHS[0] <= a <= _LENGTHS[1] and _NOISES[0] <= b <= _NOISES[1]:
                value, square = deviance(rows, seen, np.exp(a), np.exp(b))
                if value < least:
                    least, variance, best_x, best_y = value, square, a, b
        x, y = best_x, best_y
        if not least < before:
            across, along = across / 2.0, along / 2.0
    return np.exp(x), np.exp(y), variance


@compiled
def smooth(
    model: System,
    channels: Floats,
    noises: Floats,
    values: Floats,
    seen: Flags,
    first: int,
    last: int,
) -> tuple[Floats, Floats]:
    """Return mean, (F, 3), and variance, (F,), of the last channel in some frames.

    The covariances are the same for the three coordinates. Forward a Kalman filter, backward the
    smoother of Bryson and Frazier, which inverts nothing.

    Parameters
    ----------
    model
        Transition, covariance of its noise, and of the first state; (D, D) each.
    channels
        What each channel observes of the state, (C, D).
    noises
        The variances of its noise, (C,).
    values, seen
        Observations, (T, C, 3), and where there are any, (T, C).
    first, last
        Frames ``first`` to ``last - 1`` are wanted.
    """
    moves, drift, covariance = model[0], model[1], model[2].copy()
    frames, count, size = len(values), len(channels), len(moves)
    back = np.ascontiguousarray(moves.T)
    states, covariances = np.empty((frames, size, 3)), np.empty((frames, size, size))
    gains, errors = np.zeros((frames, count, size)), np.zeros((frames, count, 3))
    squares = np.ones((frames, count))
    state, half = np.zeros((size, 3)), np.empty((size, size))
    for t in range(frames):
        states[t], covariances[t] = state, covariance
        for c in range(count):
            if seen[t, c]:
                squares[t, c] = _observe(
                    channels[c],
                    noises[c],
                    values[t, c],
                    state,
                    covariance,
                    gains[t, c],
                    errors[t, c],
                )
        _times(moves, state)
        _congruent(moves, back, covariance, half)
        covariance += drift
    mean, variance = np.empty((last - first, 3)), np.empty(last - first)
    pull, weight = np.zeros((size, 3)), np.zeros((size, size))
    for t in range(frames - 1, first - 1, -1):
        _times(back, pull)
        _congruent(back, moves, weight, half)
        for c in range(count - 1, -1, -1):
            if seen[t, c]:
                _look_back(channels[c], gains[t, c], errors[t, c], squares[t, c], pull, weight)
        if t < last:
            variance[t - first] = _known(
                channels[-1], states[t], covariances[t], pull, weight, mean[t - first]
            )
    return mean, variance


@inner
def _observe(
    channel: Floats,
    noise: float,
    value: Floats,
    state: Floats,
    covariance: Floats,
    gain: Floats,
    error: Floats,
) -> float:
    """Add an observation; write its gain and its error over its variance, which is returned."""
    size, square = len(state), noise
    for i in range(size):
        gain[i] = 0.0
        for j in range(size):
            gain[i] += covariance[i, j] * channel[j]
        square += channel[i] * gain[i]
    for k in range(3):
        error[k] = value[k]
        for i in range(size):
            error[k] -= channel[i] * state[i, k]
        error[k] /= square
    for i in range(size):
        for k in range(3):
            state[i, k] += gain[i] * error[k]
        for j in range(size):
            covariance[i, j] -= gain[i] * gain[j] / square
    gain /= square
    return square


@inner
def _look_back(
    channel: Floats, gain: Floats, error: Floats, square: float, pull: Floats, weight: Floats
) -> None:
    """Take an observation into what later ones tell of the state before."""
    size = len(pull)
    for k in range(3):
        toward = error[k]
        for i in range(size):
            toward -= gain[i] * pull[i, k]
        for i in range(size):
            pull[i, k] += channel[i] * toward
    along, total = np.zeros(size), 1.0 / square
    for i in range(size):
        for j in range(size):
            along[i] += weight[i, j] * gain[j]
        total += gain[i] * along[i]
    for i in range(size):
        for j in range(size):
            weight[i, j] += (
                channel[i] * total * channel[j] - along[i] * channel[j] - channel[i] * along[j]
            )


@inner
def _known(
    wanted: Floats, state: Floats, covariance: Floats, pull: Floats, weight: Floats, mean: Floats
) -> float:
    """Write the mean of a channel, all observations being known, and return its variance."""
    size, variance = len(wanted), 0.0
    along = np.zeros(size)
    for i in range(size):
        for j in range(size):
            along[i] += covariance[i, j] * wanted[j]
    mean[:] = 0.0
    for i in range(size):
        variance += wanted[i] * along[i]
        for j in range(size):
            variance -= along[i] * weight[i, j] * along[j]
        for k in range(3):
            mean[k] += wanted[i] * state[i, k] + along[i] * pull[i, k]
    return max(variance, 0.0)
