"""The loops of the Kalman smoother and filter, compiled: import this module only when it runs.

Time is counted in frames and the variance of the measurement is 1. Nothing is known of the state
before the first frame, which only information (the inverse of a covariance) can say exactly: the
forward pass carries the information matrix L and the vector ``e = L x``, the backward pass the
state itself.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


@kernel()
def transition(order: int, density: float) -> tuple[Floats, Floats]:
    """Return F and Q, (d, d) each, time in frames."""
    step, noise = np.eye(order), np.empty((order, order))
    for i in range(order):
        for j in range(order):
            up, across = order - 1 - i, order - 1 - j
            scale = math.gamma(up + 1.0) * math.gamma(across + 1.0) * (up + across + 1.0)
            noise[i, j] = density / scale
            if j > i:
                step[i, j] = 1.0 / math.gamma(j - i + 1.0)
    return step, noise


@kernel()
def gains(frames: int, order: int, density: float) -> tuple[Floats, Floats, Floats, Floats]:
    """Return what does not depend on the data.

    With the state ``x[t+1] = F x[t] + w``, w of covariance Q: in the forward pass
    ``M = F'^-1 L[t] F^-1``, ``W = (I + M Q)^-1`` and ``L[t+1] = W M + H'H``.

    Parameters
    ----------
    frames
        T.
    order
        d, the number of components: position, velocity, ...
    density
        Density of the white noise that drives the last component.

    Returns
    -------
    carry : (T, d, d) array
        ``W F'^-1``: the next frame's vector is ``carry[t] e + H' z``.
    inverse : (T, d, d) array
        ``F^-1 Q W F'^-1``: covariance of the state if the next one is known; in the last frame
        of the state itself.
    gain : (T, d, d) array
        ``F^-1 (I + Q M)^-1``: the state is ``inverse[t] e + gain[t] x[t+1]``.
    variance : (T,) array
        Variance of the position, all frames being known.
    """
    step, noise = transition(order, density)
    back = np.linalg.inv(step)
    forth = np.ascontiguousarray(back.T)
    carry, inverse = np.zeros((frames, order, order)), np.zeros((frames, order, order))
    gain, variance = np.zeros((frames, order, order)), np.empty(frames)
    information: NDArray[np.floating] = np.zeros((order, order))
    information[0, 0] = 1.0
    for t in range(frames - 1):
        moved = forth @ information @ back
        kept = np.linalg.inv(np.eye(order) + moved @ noise)
        np.dot(kept, forth, carry[t])
        np.dot(back @ noise, carry[t], inverse[t])
        for i in range(order):
            for j in range(order):
                gain[t, i, j] = carry[t, j, i]
        information = kept @ moved
        information = 0.5 * (information + information.T)
        information[0, 0] += 1.0
    last = np.linalg.inv(information)
    for i in range(order):
        for j in range(order):
            inverse[frames - 1, i, j] = last[i, j]
    covariance = inverse[frames - 1].copy()
    variance[frames - 1] = covariance[0, 0]
    for t in range(frames - 2, -1, -1):
        here = np.ascontiguousarray(gain[t])
        covariance = inverse[t] + here @ covariance @ here.T
        variance[t] = covariance[0, 0]
    return carry, inverse, gain, variance


@kernel()
def smooth(values: Floats, carry: Floats, inverse: Floats, gain: Floats) -> Floats:
    """Return the positions that runs of one length have, all frames being known.

    Parameters
    ----------
    values : (T, N) array of float64
        Runs side by side.
    carry, inverse, gain
        From `gains`.
    """
    frames, columns = values.shape
    order = carry.shape[1]
    smoothed = np.empty_like(values)
    vector, state, last = np.zeros((frames, order)), np.zeros(order), np.zeros(order)
    for column in range(columns):
        vector[0] = 0.0
        vector[0, 0] = values[0, column]
        for t in range(1, frames):
            for i in range(order):
                vector[t, i] = 0.0
                for j in range(order):
                    vector[t, i] += carry[t - 1, i, j] * vector[t - 1, j]
            vector[t, 0] += values[t, column]
        last[:] = 0.0
        for t in range(frames - 1, -1, -1):
            for i in range(order):
                state[i] = 0.0
                for j in range(order):
                    state[i] += inverse[t, i, j] * vector[t, j] + gain[t, i, j] * last[j]
            for i in range(order):
                last[i] = state[i]
            smoothed[t, column] = state[0]
    return smoothed


@kernel()
def follow(values: Floats, gains: Floats) -> Floats:
    """Return the filtered positions of runs of one length; see `nodegraph_smooth.kalman_filter`.

    Parameters
    ----------
    values : (T, R, 3) array of float64
        Relative to each run's first sample.
    gains : (G, d) array of float64
        In each frame of a run; the last holds from there on.
    """
    filtered = np.empty_like(values)
    state = np.zeros(gains.shape[1])
    for run in range(values.shape[1]):
        for axis in range(3):
            state[:] = 0.0
            for t in range(len(values)):
                _update(state, values[t, run, axis], gains[min(t, len(gains) - 1)])
                filtered[t, run, axis] = state[0]
    return filtered


@kernel("state")
def advance(state: Floats, values: Floats, age: NDArray[np.integer], gains: Floats) -> None:
    """Filter the next frame of some runs, as `follow` does.

    Parameters
    ----------
    state : (R, 3, d) array of float64
        State in the frame before, zeros before the first of a run; that of this one is written
        there.
    values : (R, 3) array of float64
    age : (R,) array of int
        Frames since the run's first.
    gains
        As for `follow`.
    """
    for run in range(len(values)):
        gain = gains[min(age[run], len(gains) - 1)]
        for axis in range(3):
            _update(state[run, axis], values[run, axis], gain)


@kernel("state", forceinline=True, no_cpython_wrapper=True)
def _update(state: Floats, value: float, gain: Floats) -> None:
    """Predict the state of the next frame, and correct it by the sample."""
    last = len(state) - 1
    for i in range(last):
        change, factor = 0.0, 1.0
        for j in range(i + 1, last + 1):
            factor /= j - i
            change += factor * state[j]
        state[i] += change
    off = value - state[0]
    for i in range(last + 1):
        state[i] += gain[i] * off
