"""The loop over markers of a running score, compiled: import this module only when it runs."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

inlined = partial(kernel, forceinline=True, no_cpython_wrapper=True)

FRAMES, PRESENT, SQUARES, SUM, LARGEST, X, Y, Z = range(8)
"""What is kept of a marker: of its gap, and its error in the frame before."""
GAPS, FILLED, WHOLE, RMSE, MAE, MAX, JUMPS, JUMP = range(8)
"""What is kept of all closed gaps: three counts, of which `FILLED` is of shares, and sums."""


@kernel()
def first_unknown(
    truth: NDArray[np.float64], hidden: NDArray[np.bool_], of_hidden: NDArray[np.intp]
) -> int:
    """Return the first of the truth's markers that is hidden and has no sample, -1 if none is."""
    for marker in range(len(truth)):
        if hidden[of_hidden[marker]] and math.isnan(truth[marker, 0]):
            return marker
    return -1


@kernel("open_gaps", "closed")
def advance(
    open_gaps: NDArray[np.float64],
    closed: NDArray[np.float64],
    estimate: NDArray[np.float64],
    truth: NDArray[np.float64],
    hidden: NDArray[np.bool_],
    of_estimate: NDArray[np.intp],
    of_hidden: NDArray[np.intp],
) -> NDArray[np.float64]:
    """Take the next frame; return the numbers so far, (6,): see `nodegraph_score.gaps`.

    Parameters
    ----------
    open_gaps : (M, 8) array of float64
        Changed; zeros at first.
    closed : (8,) array of float64
        Changed; zeros at first.
    estimate, truth : (M, 3) arrays of float64
    hidden : (M,) array of bool
    of_estimate, of_hidden : (M,) arrays of int
        Where the truth's markers stand in these.
    """
    for marker in range(len(truth)):
        gap, guess, true = open_gaps[marker], estimate[of_estimate[marker]], truth[marker]
        x, y, z = guess[0] - true[0], guess[1] - true[1], guess[2] - true[2]
        if hidden[of_hidden[marker]]:
            _extend(gap, _length(x, y, z))
        elif gap[FRAMES] > 0.0:
            jump = _length(x - gap[X], y - gap[Y], z - gap[Z])
            if gap[PRESENT] == gap[FRAMES] and not math.isnan(jump):
                closed[JUMPS] += 1.0
                closed[JUMP] += jump
            _add(closed, gap)
            gap[:X] = 0.0
        gap[X], gap[Y], gap[Z] = x, y, z
    total = closed.copy()
    for marker in range(len(truth)):
        if open_gaps[marker, FRAMES] > 0.0:
            _add(total, open_gaps[marker])
    return _means(total)


@inlined()
def _length(x: float, y: float, z: float) -> float:
    return math.sqrt(x**2 + y**2 + z**2)


@inlined("gap")
def _extend(gap: NDArray[np.float64], length: float) -> None:
    """Count a hidden sample, and how long its error is."""
    gap[FRAMES] += 1.0
    if not math.isnan(length):
        gap[PRESENT] += 1.0
        gap[SQUARES] += length**2
        gap[SUM] += length
        gap[LARGEST] = max(gap[LARGEST], length)


@inlined()
def _means(total: NDArray[np.float64]) -> NDArray[np.float64]:
    numbers = np.full(6, np.nan)
    numbers[0] = total[GAPS]
    if total[GAPS] > 0.0:
        numbers[1] = total[FILLED] / total[GAPS]
    if total[WHOLE] > 0.0:
        numbers[2] = total[RMSE] / total[WHOLE]
        numbers[3] = total[MAE] / total[WHOLE]
        numbers[4] = total[MAX] / total[WHOLE]
    if total[JUMPS] > 0.0:
        numbers[5] = total[JUMP] / total[JUMPS]
    return numbers


@inlined("total")
def _add(total: NDArray[np.float64], gap: NDArray[np.float64]) -> None:
    """Count a gap as it is."""
    frames = gap[FRAMES]
    total[GAPS] += 1.0
    total[FILLED] += gap[PRESENT] / frames
    if gap[PRESENT] == frames:
        total[WHOLE] += 1.0
        total[RMSE] += math.sqrt(gap[SQUARES] / frames)
        total[MAE] += gap[SUM] / frames
        total[MAX] += gap[LARGEST]
