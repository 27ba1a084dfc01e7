"""Frames that hang together, compiled: import this module only when one runs.

The matrix of the normal equations is block tridiagonal: a block of K x K for each frame, and
``-smoothness I`` between neighbours. Block elimination forward and substitution backward.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Flags = NDArray[np.bool_]
    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]


@kernel()
def times(
    grams: Floats, which: Integers, coupled: Flags, smoothness: float, weights: Floats
) -> Floats:
    """Return the matrix times the weights.

    Parameters
    ----------
    grams : (P, K, K) array of float64
    which : (T,) array of int
        The gram of each frame.
    coupled : (T,) array of bool
        Whether a frame hangs together with the one before.
    smoothness
    weights : (T, K) array of float64
    """
    product = np.empty_like(weights)
    for frame in range(len(weights)):
        np.dot(grams[which[frame]], weights[frame], product[frame])
        for i in range(weights.shape[1] if coupled[frame] else 0):
            step = smoothness * (weights[frame, i] - weights[frame - 1, i])
            product[frame, i] += step
            product[frame - 1, i] -= step
    return product


@kernel("inverses")
def eliminate(
    grams: Floats,
    which: Integers,
    coupled: Flags,
    smoothness: float,
    diagonal: Floats,
    inverses: Floats,
) -> None:
    """Write the inverse of each frame's block, what hangs before it being eliminated.

    Parameters
    ----------
    grams, which, coupled, smoothness
        As above.
    diagonal : (T, K) array of float64
        Added to the matrix's diagonal.
    inverses : (T, K, K) array of float64
        Written.
    """
    frames, count = diagonal.shape
    block = np.empty((count, count))
    for frame in range(frames):
        both = smoothness * int(coupled[frame])
        both += smoothness * int(frame + 1 < frames and coupled[frame + 1])
        for i in range(count):
            for j in range(count):
                block[i, j] = grams[which[frame], i, j]
            block[i, i] += diagonal[frame, i] + both
            for j in range(count if coupled[frame] else 0):
                block[i, j] -= smoothness**2 * inverses[frame - 1, i, j]
        inverse = np.linalg.inv(block)
        for i in range(count):
            for j in range(count):
                inverses[frame, i, j] = inverse[i, j]


@kernel()
def substitute(inverses: Floats, coupled: Flags, smoothness: float, right: Floats) -> Floats:
    """Return the solution for a right-hand side."""
    solution, product = right.copy(), np.empty(right.shape[1])
    for frame in range(1, len(solution)):
        if coupled[frame]:
            np.dot(inverses[frame - 1], solution[frame - 1], product)
            for i in range(len(product)):
                solution[frame, i] += smoothness * product[i]
    for frame in range(len(solution) - 1, -1, -1):
        if frame + 1 < len(solution) and coupled[frame + 1]:
            for i in range(len(product)):
                solution[frame, i] += smoothness * solution[frame + 1, i]
        np.dot(inverses[frame], solution[frame], product)
        for i in range(len(product)):
            solution[frame, i] = product[i]
    return solution
