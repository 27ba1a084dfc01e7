"""Running vector medians, compiled: import this module only when a filter runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Integers = NDArray[np.integer]

inlined = partial(kernel, forceinline=True, no_cpython_wrapper=True)

_TIE = 1.0 + 1e-9
"""Sums this close are equal, so that rounding does not choose between them."""


@kernel()
def medians(positions: Floats, reach: int) -> tuple[Floats, Floats]:
    """Return the vector median of each sample's window, and the sample's distance from it.

    Parameters
    ----------
    positions : (T, M, 3) array of float64
        NaN where missing.
    reach
        Frames on each side.

    Returns
    -------
    (T, M, 3) array of float64
        The median; the sample itself where it is not judged.
    (T, M) array of float64
        0 where it is not judged, NaN where missing.
    """
    frames, markers = positions.shape[:2]
    medians, off = positions.copy(), np.empty((frames, markers))
    width = min(2 * reach + 1, frames)
    slots, inside = np.empty(frames, np.int64), np.empty(width, np.int64)
    for frame in range(frames):
        slots[frame] = frame % width
    total = np.empty(width)
    # of every two frames of the window, each with its slot as row and column
    apart = np.empty((width, width))
    for marker in range(markers):
        track, missing = positions[:, marker].copy(), -1
        for frame in range(min(reach, frames)):
            _enter(apart, track, slots, frame)
            missing = frame if track[frame, 0] != track[frame, 0] else missing
        for now in range(frames):
            last = now + reach
            if last < frames:
                _enter(apart, track, slots, last)
                missing = last if track[last, 0] != track[last, 0] else missing
            if missing < now - reach and now >= reach and last < frames:
                median = _of_full(apart, total, slots, now, reach)
            else:
                off[now, marker] = apart[slots[now], slots[now]]
                count = _gather(inside, track, now, reach)
                if count == 0:
                    continue
                _sum_distances(total[:count], apart, slots, inside[:count])
                median = _least(total[:count], inside[:count], now)
            for axis in range(3):
                medians[now, marker, axis] = track[median, axis]
            off[now, marker] = apart[slots[now], slots[median]]
    return medians, off


@kernel()
def spreads(positions: Floats, medians: Floats, reach: int) -> Floats:
    """Return the median distance of each window's samples from the window's vector median.

    Parameters
    ----------
    positions, medians : (T, M, 3) arrays of float64
    reach
        Frames on each side.

    Returns
    -------
    (T, M) array of float64
        Infinite where a sample is not judged.
    """
    frames, markers = positions.shape[:2]
    spread = np.full((frames, markers), np.inf)
    width = min(2 * reach + 1, frames)
    inside, distance = np.empty(width, np.int64), np.empty(width)
    for marker in range(markers):
        track = positions[:, marker].copy()
        for now in range(frames):
            count = _gather(inside, track, now, reach)
            for index in range(count):
                distance[index] = _apart(track[inside[index]], medians[now, marker])
            if count:
                spread[now, marker] = _middle(distance[:count])
    return spread


@inlined("apart")
def _enter(apart: Floats, track: Floats, slots: Integers, frame: int) -> None:
    """Write the distances of a frame from itself and from those before it in its windows."""
    slot = slots[frame]
    for other in range(max(0, frame - len(apart) + 1), frame + 1):
        length = _apart(track[frame], track[other])
        apart[slot, slots[other]] = apart[slots[other], slot] = length


@inlined("total")
def _of_full(apart: Floats, total: Floats, slots: Integers, now: int, reach: int) -> int:
    """Return the median's frame of a window without gaps, whose slots need no list."""
    width = len(total)
    for row in range(width):
        length = 0.0
        for other in range(width):
            length += apart[row, other]
        total[row] = length
    bar, best, first = _lowest(total) * _TIE, -1, slots[now - reach]
    for step in range(width):
        slot = first + step if first + step < width else first + step - width
        if total[slot] <= bar and (best < 0 or abs(step - reach) < abs(best - reach)):
            best = step
    return now - reach + best


@inlined("inside")
def _gather(inside: Integers, track: Floats, now: int, reach: int) -> int:
    """Collect the present frames of a window; none if there is none before or after its middle."""
    frames = len(track)
    count = before = after = 0
    if track[now, 0] != track[now, 0]:
        return 0
    for frame in range(max(0, now - reach), min(frames, now + reach + 1)):
        if track[frame, 0] == track[frame, 0]:
            inside[count] = frame
            count += 1
            before += frame < now
            after += frame > now
    return count if before and after else 0


@inlined("total")
def _sum_distances(total: Floats, apart: Floats, slots: Integers, inside: Integers) -> None:
    for row in range(len(inside)):
        line, length = apart[slots[inside[row]]], 0.0
        for other in range(len(inside)):
            length += line[slots[inside[other]]]
        total[row] = length


@inlined()
def _least(total: Floats, inside: Integers, now: int) -> int:
    """Return the frame with the least sum; of equal ones the nearest to `now`, the earlier one."""
    bar, best = _lowest(total) * _TIE, -1
    for index in range(len(inside)):
        nearer = best < 0 or abs(inside[index] - now) < abs(best - now)
        if total[index] <= bar and nearer:
            best = inside[index]
    return best


@inlined()
def _lowest(values: Floats) -> float:
    lowest = np.inf
    for value in values:
        lowest = min(lowest, value)
    return lowest


@inlined("values")
def _middle(values: Floats) -> float:
    """Return the median of a few values, which are sorted in place."""
    for index in range(1, len(values)):
        value, place = values[index], index
        while place > 0 and values[place - 1] > value:
            values[place] = values[place - 1]
            place -= 1
        values[place] = value
    half = len(values) // 2
    middle: float = values[half]
    return middle if len(values) % 2 else 0.5 * (values[half - 1] + middle)


@inlined()
def _apart(point: Floats, other: Floats) -> float:
    x, y, z = point[0] - other[0], point[1] - other[1], point[2] - other[2]
    return math.sqrt(x * x + y * y + z * z)
