"""The loops of the low-dimensional smoother, compiled: import this module only when it runs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel()


@compiled
def smooth(rows: Any, missing: Any, basis: Any, noise: Any, first: Any, drift: Any) -> Any:
    """Return the state in every frame, all frames being known, and its covariance.

    The state is ``x[t+1] = x[t] + w``, w of covariance Q, and a row is ``C x[t] + v``, v of
    independent variances. Each entry that is not missing corrects the state by itself. The
    pass back is that of Rauch, Tung and Striebel.

    Parameters
    ----------
    rows, missing : (T, P) arrays
    basis : (P, D) array of float64
        C.
    noise : (P,) array of float64
        The variances of v, positive.
    first : (D,) array of float64
        Variances of the state before the first frame; its mean is 0.
    drift : (D, D) array of float64
        Q.

    Returns
    -------
    states : (T, D) array
    covariances : (T, D, D) array
    """
    frames, width = rows.shape
    size = len(first)
    states, covariances = np.zeros((frames, size)), np.zeros((frames, size, size))
    state, covariance, gain = np.zeros(size), np.diag(first), np.empty(size)
    for t in range(frames):
        if t:
            covariance = covariances[t - 1] + drift
        for p in range(width):
            if missing[t, p]:
                continue
            variance, off = noise[p], rows[t, p]
            for i in range(size):
                gain[i] = 0.0
                for j in range(size):
                    gain[i] += covariance[i, j] * basis[p, j]
                variance += gain[i] * basis[p, i]
                off -= basis[p, i] * state[i]
            for i in range(size):
                state[i] += gain[i] * off / variance
                for j in range(i + 1):
                    covariance[i, j] -= gain[i] * gain[j] / variance
                    covariance[j, i] = covariance[i, j]
        states[t], covariances[t] = state, covariance
    for t in range(frames - 2, -1, -1):
        back = _divided(covariances[t], covariances[t] + drift)
        states[t] += back @ (states[t + 1] - states[t])
        ahead = covariances[t + 1] - covariances[t] - drift
        covariances[t] += back @ ahead @ np.ascontiguousarray(back.T)
    return states, covariances


@compiled
def _divided(upper: Any, lower: Any) -> Any:
    """Return A inv(B), both symmetric and B positive definite, by Cholesky's factors."""
    size = len(lower)
    factor, quotient = np.zeros_like(lower), upper.copy()
    for i in range(size):
        for j in range(i + 1):
            rest = lower[i, j]
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            factor[i, j] = math.sqrt(rest) if i == j else rest / factor[j, j]
    for row in range(size):
        for i in range(size):
            for k in range(i):
                quotient[row, i] -= factor[i, k] * quotient[row, k]
            quotient[row, i] /= factor[i, i]
        for i in range(size - 1, -1, -1):
            for k in range(i + 1, size):
                quotient[row, i] -= factor[k, i] * quotient[row, k]
            quotient[row, i] /= factor[i, i]
    return quotient
