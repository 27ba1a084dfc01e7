"""The loops that smooth runs by fixed weights, compiled: import this module only when it runs.

Each output sample is written as its own sample plus weighted differences from it, so that a
trajectory that stands still comes out as it went in. The sums are contracted to fused
multiply-adds, which round less often.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

compiled = partial(kernel, fastmath={"contract"})
inlined = partial(kernel, fastmath={"contract"}, forceinline=True, no_cpython_wrapper=True)

BLOCK = 2048
"""Numbers that are worked on at a time: what a pass has touched, the next finds in the cache."""


@compiled("out")
def curve_into(
    out: Floats,
    values: Floats,
    weights: Floats,
    marker: Integers,
    start: Integers,
    stop: Integers,
    rows: Floats,
) -> int:
    """Write the curve of each run that is long enough to have a regular middle.

    Parameters
    ----------
    out, values : (T, M, 3) arrays of float64, contiguous and apart from each other
        NaN where `values` is in no run, and then in `out`.
    weights : (K,) array of float64
        See `filter_into`.
    marker, start, stop : (R,) arrays of int
        All runs of present samples.
    rows : (S, W) array of float64
        Weights of a run's first W samples in each of its first S output samples; the same from
        its end backward. W is at most 2 S.

    Returns
    -------
    int
        How many runs are shorter than 2 S. What is written there is of no use.
    """
    filter_into(out.reshape(-1), values.reshape(-1), 3 * values.shape[1], weights)
    short = 0
    for run in range(len(marker)):
        if stop[run] - start[run] < 2 * len(rows):
            short += 1
        else:
            _end_into(out, values, marker[run], start[run], 1, rows)
            _end_into(out, values, marker[run], stop[run] - 1, -1, rows)
    return short


@compiled()
def runs_of(
    present: NDArray[np.bool_],
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Return marker, start and stop of each run of True, by marker and then by time.

    Of a window of a few frames `nodegraph_mocap.frame_ranges.runs_of` takes longer than all else.

    Parameters
    ----------
    present : (T, M) array of bool
    """
    frames, markers = present.shape
    runs, count = np.empty((3, markers * ((frames + 1) // 2)), np.intp), 0
    for marker in range(markers):
        start = -1
        for frame in range(frames + 1):
            here = frame < frames and present[frame, marker]
            if here and start < 0:
                start = frame
            elif start >= 0 and not here:
                runs[0, count], runs[1, count], runs[2, count] = marker, start, frame
                start, count = -1, count + 1
    return runs[0, :count], runs[1, :count], runs[2, :count]


@compiled("out")
def rows_into(out: Floats, values: Floats, marker: Integers, start: Integers, rows: Floats) -> None:
    """Write whole runs of one length, each sample a weighted mean of all.

    Parameters
    ----------
    out, values : (T, M, 3) arrays of float64
    marker, start : (R,) arrays of int
    rows : (L, L) array of float64
    """
    for run in range(len(marker)):
        _end_into(out, values, marker[run], start[run], 1, rows)


@compiled("out")
def filter_into(out: Floats, values: Floats, stride: int, weights: Floats) -> None:
    """Write each number plus the weighted differences of those around it.

    ``out[i] = x[i] + sum(w[k-1] ((x[i - k stride] + x[i + k stride]) - 2 x[i]))``, k from 1.
    Numbers nearer than that to either end are copied; NaN spreads to what is made with it.

    Parameters
    ----------
    out, values : (N,) arrays of float64, contiguous and apart from each other
    stride
        Numbers per frame; N is a multiple of it.
    weights : (K,) array of float64
    """
    size = len(values)
    reach = min(len(weights) * stride, size)
    for i in range(reach):
        out[i], out[size - 1 - i] = values[i], values[size - 1 - i]
    if len(weights) == 1:
        _nearest_into(out, values, stride, weights[0])
        return
    for first in range(reach, size - reach, BLOCK):
        last = min(first + BLOCK, size - reach)
        middle, target = values[first:last], out[first:last]
        for i in range(len(target)):
            target[i] = middle[i]
        for k in range(len(weights)):
            shift, weight = (k + 1) * stride, weights[k]
            before, after = (
                values[first - shift : last - shift],
                values[first + shift : last + shift],
            )
            for i in range(len(target)):
                both = before[i] + after[i]
                target[i] += weight * (both - (middle[i] + middle[i]))


@inlined("out")
def _nearest_into(out: Floats, values: Floats, stride: int, weight: float) -> None:
    """Write what has a frame before and one after, three frames at a time.

    A number is loaded once for the three that it goes into.
    """
    frames = len(values) // max(stride, 1)
    tripled = 1 + 3 * (max(frames - 2, 0) // 3)
    for frame in range(1, tripled, 3):
        at = frame * stride
        before, first = values[at - stride : at], values[at : at + stride]
        second, third = (
            values[at + stride : at + 2 * stride],
            values[at + 2 * stride : at + 3 * stride],
        )
        after = values[at + 3 * stride : at + 4 * stride]
        out_first, out_second = out[at : at + stride], out[at + stride : at + 2 * stride]
        out_third = out[at + 2 * stride : at + 3 * stride]
        for i in range(stride):
            a, b, c = first[i], second[i], third[i]
            out_first[i] = a + weight * ((before[i] + b) - (a + a))
            out_second[i] = b + weight * ((a + c) - (b + b))
            out_third[i] = c + weight * ((b + after[i]) - (c + c))
    for i in range(tripled * stride, len(values) - stride):
        both = values[i - stride] + values[i + stride]
        out[i] = values[i] + weight * (both - (values[i] + values[i]))


@inlined("out")
def _end_into(
    out: Floats, values: Floats, marker: int, frame: int, step: int, rows: Floats
) -> None:
    """Write a run's first samples, counted from a frame forward or (step -1) backward in time."""
    for row in range(len(rows)):
        here = frame + step * row
        for axis in range(3):
            own, total = values[here, marker, axis], 0.0
            for column in range(rows.shape[1]):
                total += rows[row, column] * (values[frame + step * column, marker, axis] - own)
            out[here, marker, axis] = own + total
