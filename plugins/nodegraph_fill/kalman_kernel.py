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
def information(basis: Floats, noise: Floats, missing: Flags) -> Floats:
    """Return ``I = sum_j c_j c_j' / r_j`` of every frame, over the coordinates that it has.

    Parameters
    ----------
    basis : (P, D) array of float64
        A row c for each coordinate.
    noise : (P,) array of float64
        r.
    missing : (T, P) array of bool

    Returns
    -------
    (T, D, D) array
    """
    frames, width = missing.shape
    size = basis.shape[1]
    information = np.empty((frames, size, size))
    total = (basis.T / noise) @ basis
    for t in range(frames):
        here = information[t]
        if t and np.array_equal(missing[t], missing[t - 1]):
            here[:] = information[t - 1]
            continue
        # the fewer of what a frame has and what it lacks
        has = 2 * np.count_nonzero(missing[t]) > width
        here[:] = 0.0
        if not has:
            here[:] = total
        for j in range(width):
            if missing[t, j] != has:
                row, weight = basis[j], (1.0 if has else -1.0) / noise[j]
                for i in range(size):
                    line, factor = here[i], weight * row[i]
                    for k in range(size):
                        line[k] += factor * row[k]
    return information


@compiled
def smooth(information: Floats, vectors: Floats, first: Floats) -> tuple[Floats, Floats]:
    """Return the state in every frame, all frames being known, and its covariance.

    The state is ``x[t+1] = x[t] + w``, w of covariance 1. What is measured in a frame has the
    likelihood ``exp(-x' I x / 2 + i' x)``. The precision of all states is then block
    tridiagonal, with -1 beside the diagonal. Going forward, W is the inverse of what eliminating
    the frames before leaves of a diagonal block, ``W[t+1] = inv(2 + I[t+1] - W[t])`` and
    ``h[t+1] = i[t+1] + W[t] h[t]``; going back, ``x[t] = W[t] (h[t] + x[t+1])`` and
    ``P[t] = W[t] + W[t] P[t+1] W[t]``. This is the Kalman filter and the smoother of Rauch, Tung
    and Striebel in the form of Cholesky's factors.

    Parameters
    ----------
    information : (T, D, D) array of float64
        I.
    vectors : (T, D) array of float64
        i.
    first : (D, D) array of float64
        Covariance of the state before the first frame; its mean is 0. May be singular.

    Returns
    -------
    states : (T, D) array
    covariances : (T, D, D) array
    """
    states, covariances = vectors.copy(), np.empty_like(information)
    last, identity = len(states) - 1, np.eye(len(first))
    start = _symmetric(np.linalg.solve(identity + first @ information[0], first))
    covariances[0] = _symmetric(np.linalg.solve(identity + start, start)) if last else start
    for t in range(1, last + 1):
        before = covariances[t - 1]
        states[t] += before @ states[t - 1]
        ahead = 2.0 * identity if t < last else identity
        covariances[t] = _symmetric(np.linalg.inv(ahead + information[t] - before))
    states[last] = covariances[last] @ states[last]
    for t in range(last - 1, -1, -1):
        back = covariances[t]
        states[t] = back @ (states[t] + states[t + 1])
        covariances[t] = back + _symmetric(back @ covariances[t + 1] @ back)
    return states, covariances


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
def _symmetric(matrix: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return a matrix without what rounding makes it differ from its transpose by."""
    return (matrix + matrix.T) / 2.0
