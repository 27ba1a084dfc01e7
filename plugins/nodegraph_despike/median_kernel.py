"""Running vector medians, compiled: import this module only when a filter runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from nodegraph import kernel

compiled = kernel()
inlined = kernel(forceinline=True)

_TIE = 1.0 + 1e-9
"""Sums this close are equal, so that rounding does not choose between them."""


@compiled
def medians(positions: Any, reach: int) -> Any:
    """Return, for each sample, the vector median of its window and the spread about it.

    Parameters
    ----------
    positions : (T, M, 3) array of float64
        NaN where missing.
    reach
        Frames on each side.

    Returns
    -------
    (T, M) array of int
        The frame of the median; its own frame where the sample is not judged.
    (T, M) array of float64
        Median distance of the window's samples from it; infinite where it is not judged.
    """
    frames, markers = positions.shape[:2]
    place, spread = np.empty((frames, markers), np.int64), np.full((frames, markers), np.inf)
    width = min(2 * reach + 1, frames)
    inside, slots = np.empty(width, np.int64), np.empty(width, np.int64)
    total, distance = np.empty(width), np.empty(width)
    # of every two frames of the window, each in the row and column of its number modulo width
    apart = np.empty((width, width))
    for marker in range(markers):
        track = positions[:, marker].copy()
        for frame in range(min(reach, frames)):
            _enter(apart, track, frame)
        for now in range(frames):
            if now + reach < frames:
                _enter(apart, track, now + reach)
            place[now, marker] = now
            count = _gather(inside, track, now, reach)
            if count == 0:
                continue
            for index in range(count):
                slots[index] = inside[index] % width
            _sum_distances(total[:count], apart, slots[:count])
            median = _least(total[:count], inside[:count], now)
            for index in range(count):
                distance[index] = apart[slots[index], median % width]
            place[now, marker] = median
            spread[now, marker] = _middle(distance[:count])
    return place, spread


@inlined
def _enter(apart: Any, track: Any, frame: int) -> None:
    """Write the distances of a frame from those before it that share a window with it."""
    width = len(apart)
    slot = frame % width
    apart[slot, slot] = 0.0
    for other in range(max(0, frame - width + 1), frame):
        x, y, z = (
            track[frame, 0] - track[other, 0],
            track[frame, 1] - track[other, 1],
            track[frame, 2] - track[other, 2],
        )
        length = math.sqrt(x * x + y * y + z * z)
        apart[slot, other % width] = apart[other % width, slot] = length


@inlined
def _gather(inside: Any, track: Any, now: int, reach: int) -> int:
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


@inlined
def _sum_distances(total: Any, apart: Any, slots: Any) -> None:
    total[:] = 0.0
    for row in range(len(slots)):
        for other in range(row):
            length = apart[slots[row], slots[other]]
            total[row] += length
            total[other] += length


@inlined
def _least(total: Any, inside: Any, now: int) -> int:
    """Return the frame with the least sum; of equal ones the nearest to `now`, the earlier one."""
    bar, best = total.min() * _TIE, -1
    for index in range(len(inside)):
        nearer = best < 0 or abs(inside[index] - now) < abs(best - now)
        if total[index] <= bar and nearer:
            best = inside[index]
    return best


@inlined
def _middle(values: Any) -> float:
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
