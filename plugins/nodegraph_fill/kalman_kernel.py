"""The loops of the low-dimensional smoother, compiled: import this module only when it runs."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = partial(kernel, fastmath={"reassoc", "contract"})
inner = partial(compiled, no_cpython_wrapper=True)  # for kernels only


@compiled("states", "covariances")
def smooth(
    missing: Flags,
    basis: Floats,
    weighted: Floats,
    total: Floats,
    states: Floats,
    covariances: Floats,
) -> None:
    """Write the state in every frame, all frames being known, and its covariance.

    The state is ``x[t+1] = x[t] + w``, w of covariance 1. What a frame has, values y of the
    coordinates c with noise r, has the likelihood ``exp(-x' I x / 2 + i' x)`` with
    ``I = sum_j c_j c_j' / r_j`` and ``i = sum_j c_j y_j / r_j``. The precision of all states is
    then block tridiagonal, with -1 beside the diagonal. Going forward, W is the inverse of what
    eliminating the frames before leaves of a diagonal block, ``W[t+1] = inv(2 + I[t+1] - W[t])``
    and ``h[t+1] = i[t+1] + W[t] h[t]``; going back, ``x[t] = W[t] (h[t] + x[t+1])`` and
    ``P[t] = W[t] + W[t] P[t+1] W[t]``. This is the Kalman filter and the smoother of Rauch, Tung
    and Striebel in the form of Cholesky's factors.

    Nothing is assigned to a slice, and little is left to NumPy's functions: numba would take twice
    as long to compile.

    Parameters
    ----------
    missing : (T, P) array of bool
    basis : (P, D) array of float64
        A row c for each coordinate.
    weighted : (P, D) array of float64
        ``c / r``.
    total : (D, D) array of float64
        I of a frame that has all coordinates.
    states : (T, D) array of float64
        i; x is written there.
    covariances : (T, D, D) array of float64
        W[0] in the first frame; P is written there.
    """
    frames, size = states.shape
    known, line = total, np.empty(size)
    square, change = np.empty((size, size)), np.empty((size, size))
    for t in range(1, frames):
        before, block = covariances[t - 1], covariances[t]
        np.dot(before, states[t - 1], line)
        if t == 1 or not _equal(missing[t], missing[t - 1]):
            known = information(missing[t], basis, weighted, total)
        for i in range(size):
            states[t, i] += line[i]
            for k in range(size):
                block[i, k] = known[i, k] - before[i, k]
            block[i, i] += 2.0 if t < frames - 1 else 1.0
        _invert(block)
    np.dot(covariances[frames - 1], states[frames - 1].copy(), states[frames - 1])
    for t in range(frames - 2, -1, -1):
        back = covariances[t]
        for i in range(size):
            line[i] = states[t, i] + states[t + 1, i]
        np.dot(back, line, states[t])
        np.dot(covariances[t + 1], back, square)
        np.dot(back, square, change)
        for i in range(size):
            for k in range(size):
                back[i, k] += change[i, k]


@compiled("states", "covariances", "steps")
def smooth_linear(transition: Floats, states: Floats, covariances: Floats, steps: Floats) -> None:
    """Write the state in every frame, all frames being known, where it does not walk at random.

    As `smooth`, for the state ``x[t+1] = F x[t] + w``: what is beside the diagonal is -F. With
    ``J[t] = W[t] F'``, it is ``W[t+1] = inv(D[t+1] - F J[t])`` and ``h[t+1] = i[t+1] + J[t]' h[t]``
    going forward, and ``x[t] = W[t] h[t] + J[t] x[t+1]`` and ``P[t] = W[t] + J[t] P[t+1] J[t]'``
    going back.

    Parameters
    ----------
    transition : (D, D) array of float64
        F.
    states : (T, D) array of float64
        i; x is written there.
    covariances : (T, D, D) array of float64
        The blocks D of the diagonal; P is written there.
    steps : (D, D) array of float64
        Zeros; the sum of ``J[t] P[t+1]``, the covariances of x[t] and x[t+1], is written there.
    """
    frames, size = states.shape
    back, line = np.empty_like(covariances), np.empty(size)
    square, change = np.empty((size, size)), np.empty((size, size))
    for t in range(frames):
        block = covariances[t]
        if t > 0:
            np.dot(states[t - 1], back[t - 1], line)
            np.dot(transition, back[t - 1], square)
            for i in range(size):
                states[t, i] += line[i]
                for k in range(size):
                    block[i, k] -= square[i, k]
        _invert(block)
        np.dot(block, transition.T, back[t])
    for t in range(frames - 1, -1, -1):
        block = covariances[t]
        np.dot(block, states[t].copy(), states[t])
        if t < frames - 1:
            np.dot(back[t], states[t + 1], line)
            np.dot(back[t], covariances[t + 1], square)
            np.dot(square, back[t].T, change)
            for i in range(size):
                states[t, i] += line[i]
                for k in range(size):
                    steps[i, k] += square[i, k]
                    block[i, k] += change[i, k]


@compiled()
def information(missing: Flags, basis: Floats, weighted: Floats, total: Floats) -> Floats:
    """Return I of a frame, the sum over the coordinates that it has, from that over all."""
    # what it has is added up, or what it lacks is taken off, whichever is less
    lacking = 0
    for j in range(len(missing)):
        lacking += missing[j]
    few = 2 * lacking <= len(missing)
    known = np.empty_like(total)
    for i in range(len(total)):
        for k in range(len(total)):
            known[i, k] = total[i, k] if few else 0.0
    for j in range(len(missing)):
        if missing[j] == few:
            for i in range(len(total)):
                line, share = known[i], -basis[j, i] if few else basis[j, i]
                for k in range(len(total)):
                    line[k] += share * weighted[j, k]
    return known


@inner()
def _equal(flags: Flags, others: Flags) -> bool:
    equal = True
    for j in range(len(flags)):
        equal &= flags[j] == others[j]
    return equal


@compiled()
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


@inner("matrix")
def _invert(matrix: Floats) -> None:
    """Invert a symmetric positive definite matrix in place, by sweeps of its lower half."""
    size, column = len(matrix), np.empty(len(matrix))
    for k in range(size):
        for i in range(size):
            column[i] = matrix[k, i] if i < k else matrix[i, k]
        scale = 1.0 / column[k]
        for i in range(size):
            line, share = matrix[i], scale * column[i]
            for j in range(i + 1):
                line[j] -= share * column[j]
        for i in range(size):
            if i < k:
                matrix[k, i] = scale * column[i]
            else:
                matrix[i, k] = scale * column[i]
        matrix[k, k] = -scale
    for i in range(size):
        for j in range(i + 1):
            matrix[i, j] = -matrix[i, j]
            matrix[j, i] = matrix[i, j]
