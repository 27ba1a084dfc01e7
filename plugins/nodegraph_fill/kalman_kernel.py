"""The loops of the low-dimensional smoother, compiled: import this module only when it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = kernel(fastmath={"reassoc", "contract"})


@compiled
def smooth(
    basis: Floats, noise: Floats, missing: Flags, rows: Floats, first: Floats
) -> tuple[Floats, Floats]:
    """Return the state in every frame, all frames being known, and its covariance.

    The state is ``x[t+1] = x[t] + w``, w of covariance 1. What a frame has, values y of the
    coordinates c with noise r, has the likelihood ``exp(-x' I x / 2 + i' x)`` with
    ``I = sum_j c_j c_j' / r_j`` and ``i = sum_j c_j y_j / r_j``. The precision of all states is
    then block tridiagonal, with -1 beside the diagonal. Going forward, W is the inverse of what
    eliminating the frames before leaves of a diagonal block, ``W[t+1] = inv(2 + I[t+1] - W[t])``
    and ``h[t+1] = i[t+1] + W[t] h[t]``; going back, ``x[t] = W[t] (h[t] + x[t+1])`` and
    ``P[t] = W[t] + W[t] P[t+1] W[t]``. This is the Kalman filter and the smoother of Rauch, Tung
    and Striebel in the form of Cholesky's factors.

    Parameters
    ----------
    basis : (P, D) array of float64
        A row c for each coordinate.
    noise : (P,) array of float64
        r.
    missing : (T, P) array of bool
    rows : (T, P) array of float64
        y, zero where missing.
    first : (D, D) array of float64
        Covariance of the state before the first frame; its mean is 0. May be singular.

    Returns
    -------
    states : (T, D) array
    covariances : (T, D, D) array
    """
    last, identity = len(rows) - 1, np.eye(len(first))
    weighted = basis / noise.reshape(-1, 1)
    total = basis.T @ weighted
    information = _information(missing[0], basis, weighted, total)
    states, covariances = rows @ weighted, np.empty((len(rows), *first.shape))
    start = np.linalg.solve(identity + first @ information, first)
    covariances[0] = np.linalg.solve(identity + start, start) if last else start
    for t in range(1, last + 1):
        before = covariances[t - 1]
        states[t] += before @ states[t - 1]
        if not np.array_equal(missing[t], missing[t - 1]):
            information = _information(missing[t], basis, weighted, total)
        block = information - before
        for i in range(len(block)):
            block[i, i] += 2.0 if t < last else 1.0
        covariances[t] = _inverse(block)
    states[last] = covariances[last] @ states[last]
    for t in range(last - 1, -1, -1):
        back = covariances[t]
        states[t] = back @ (states[t] + states[t + 1])
        covariances[t] = back + back @ (covariances[t + 1] @ back)
    return states, covariances


@compiled
def _information(missing: Flags, basis: Floats, weighted: Floats, total: Floats) -> Floats:
    """Return I of a frame, the sum over the coordinates that it has, from that over all."""
    places = np.flatnonzero(missing)
    if 2 * len(places) > len(missing):
        places = np.flatnonzero(~missing)
        return basis[places].T @ weighted[places]
    return total - basis[places].T @ weighted[places]


@compiled
def spread(rows: Integers, columns: Integers, covariances: Floats, basis: Floats) -> Floats:
    """Return ``c' P c`` of entries, (E,), P being the covariance of the row's state."""
    spread = np.empty(len(rows))
    for entry in range(len(rows)):
        covariance, row, value = covariances[rows[entry]], basis[columns[entry]], 0.0
        for i in range(len(row)):
            line, product = covariance[i], 0.0
            for k in range(len(row)):
                product += line[k] * row[k]
            value += row[i] * product
        spread[entry] = value
    return spread


@compiled
def without(
    lacking: Flags,
    rows: Floats,
    states: Floats,
    covariances: Floats,
    basis: Floats,
    noise: Floats,
) -> Floats:
    """Return states, (E, D), that some of the coordinates that they were made of are taken from.

    With c the coordinates' rows of the basis, r their noise and y their values, that is
    ``x - P c' inv(r - c P c') (y - c x)``.

    Parameters
    ----------
    lacking : (E, P) array of bool
        What to take from each state.
    rows : (E, P) array of float64
        y.
    states : (E, D) array of float64
        x.
    covariances : (E, D, D) array of float64
        P.
    basis : (P, D) array of float64
    noise : (P,) array of float64
    """
    without = states.copy()
    for e in range(len(states)):
        places = np.flatnonzero(lacking[e])
        some = basis[places]
        gain = some @ covariances[e]
        left = np.diag(noise[places]) - gain @ some.T
        off = rows[e][places] - some @ states[e]
        without[e] -= np.linalg.solve(left, off) @ gain
    return without


@compiled
def _inverse(matrix: Floats) -> Floats:
    """Return the inverse of a symmetric positive definite matrix, by sweeps of its lower half."""
    size, inverse, column = len(matrix), matrix.copy(), np.empty(len(matrix))
    for k in range(size):
        for i in range(size):
            column[i] = inverse[k, i] if i < k else inverse[i, k]
        scale = 1.0 / column[k]
        for i in range(size):
            line, share = inverse[i], scale * column[i]
            for j in range(i + 1):
                line[j] -= share * column[j]
        for i in range(size):
            if i < k:
                inverse[k, i] = scale * column[i]
            else:
                inverse[i, k] = scale * column[i]
        inverse[k, k] = -scale
    for i in range(size):
        for j in range(i + 1):
            inverse[i, j] = -inverse[i, j]
            inverse[j, i] = inverse[i, j]
    return inverse
