"""Frames that hang together, compiled: import this module only when one runs.

The matrix of the normal equations is block tridiagonal: a block of K x K for each frame, and
``-smoothness I`` between neighbours. Block elimination forward and substitution backward.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel()


@compiled
def times(grams: Any, which: Any, coupled: Any, smoothness: float, weights: Any) -> Any:
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
    made = np.empty_like(weights)
    for frame in range(len(weights)):
        made[frame] = grams[which[frame]] @ weights[frame]
        if coupled[frame]:
            step = smoothness * (weights[frame] - weights[frame - 1])
            made[frame] += step
            made[frame - 1] -= step
    return made


@compiled
def eliminate(
    grams: Any, which: Any, coupled: Any, smoothness: float, diagonal: Any, made: Any
) -> None:
    """Write the inverse of each frame's block, what hangs before it being eliminated.

    Parameters
    ----------
    grams, which, coupled, smoothness
        As above.
    diagonal : (T, K) array of float64
        Added to the matrix's diagonal.
    made : (T, K, K) array of float64
        Written.
    """
    frames, count = diagonal.shape
    block = np.empty((count, count))
    for frame in range(frames):
        block[:] = grams[which[frame]]
        both = smoothness * int(coupled[frame])
        both += smoothness * int(frame + 1 < frames and coupled[frame + 1])
        for i in range(count):
            block[i, i] += diagonal[frame, i] + both
        if coupled[frame]:
            block -= smoothness**2 * made[frame - 1]
        made[frame] = np.linalg.inv(block)


@compiled
def substitute(inverses: Any, coupled: Any, smoothness: float, right: Any) -> Any:
    """Return the solution for a right-hand side."""
    made = right.copy()
    for frame in range(1, len(made)):
        if coupled[frame]:
            made[frame] += smoothness * (inverses[frame - 1] @ made[frame - 1])
    for frame in range(len(made) - 1, -1, -1):
        if frame + 1 < len(made) and coupled[frame + 1]:
            made[frame] += smoothness * made[frame + 1]
        made[frame] = inverses[frame] @ made[frame]
    return made
