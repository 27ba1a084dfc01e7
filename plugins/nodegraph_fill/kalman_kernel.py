"""The loops of the low-dimensional smoother, compiled: import this module only when it runs."""

from __future__ import annotations

from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel()


@compiled
def smooth(information: Any, vectors: Any, first: Any, drift: Any) -> Any:
    """Return the state in every frame, all frames being known, and its covariance.

    The state is ``x[t+1] = x[t] + w``, w of covariance Q. What is measured in a frame has the
    likelihood ``exp(-x' I x / 2 + i' x)``. The pass forward is the Kalman filter,
    ``P = (1 + P- I)^-1 P-`` and ``x = x- + P (i - I x-)``; the pass back is that of Rauch, Tung
    and Striebel.

    Parameters
    ----------
    information : (T, D, D) array of float64
        I.
    vectors : (T, D) array of float64
        i.
    first : (D,) array of float64
        Variances of the state before the first frame; its mean is 0.
    drift : (D, D) array of float64
        Q.

    Returns
    -------
    states : (T, D) array
    covariances : (T, D, D) array
    """
    states, covariances = np.empty_like(vectors), np.empty_like(information)
    state, covariance = np.zeros(len(first)), np.diag(first)
    for t in range(len(states)):
        if t:
            covariance = covariance + drift
        spread = np.eye(len(first)) + covariance @ information[t]
        covariance = _symmetric(np.linalg.solve(spread, covariance))
        state = state + covariance @ (vectors[t] - information[t] @ state)
        states[t], covariances[t] = state, covariance
    for t in range(len(states) - 2, -1, -1):
        ahead = covariances[t] + drift
        back = np.ascontiguousarray(np.linalg.solve(ahead, covariances[t]).T)
        states[t] += back @ (states[t + 1] - states[t])
        more = back @ (covariances[t + 1] - ahead) @ np.ascontiguousarray(back.T)
        covariances[t] = _symmetric(covariances[t] + more)
    return states, covariances


@compiled
def _symmetric(matrix: Any) -> Any:
    """Return a matrix without what rounding makes it differ from its transpose by."""
    return (matrix + matrix.T) / 2.0
