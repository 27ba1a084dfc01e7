"""The loops of the impulse filter, compiled: import this module only when it runs.

All that is compiled stays in this one file, because numba's cache does not notice an edited
helper in another one. A missing sample is NaN, so that its steps are NaN, and no comparison
with them holds.
"""

from __future__ import annotations

import math
from functools import partial
from heapq import heappop, heappush
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

inlined = partial(kernel, forceinline=True, no_cpython_wrapper=True)


@kernel("repaired")
def simultaneous(repaired: Floats, positions: Floats, bar: Floats, first: int) -> None:
    """Find bad samples and put each at the midpoint of its neighbours as they came.

    Parameters
    ----------
    repaired : (T, M, 3) array of float64
        A copy of the positions; written where samples are bad.
    positions : (T, M, 3) array of float64
        NaN where missing.
    bar : (M,) array of float64
        The length from which a marker's step is long.
    first
        The first frame that is judged, 1 or later.
    """
    _sweep(repaired, positions, bar, first)


@kernel("repaired")
def in_place(repaired: Floats, positions: Floats, bar: Floats, first: int) -> None:
    """Go through the frames once, each judged and repaired after the one before it."""
    _sweep(repaired, repaired, bar, first)


@kernel("repaired")
def redetect(repaired: Floats, positions: Floats, bar: Floats, first: int) -> None:
    """Repair a marker's worst sample, detect again, until none is left; each at most once."""
    for marker in range(positions.shape[1]):
        track = positions[:, marker : marker + 1].copy()
        _repair_worst_first(track, bar[marker], first)
        for now in range(len(track)):
            for axis in range(3):
                repaired[now, marker, axis] = track[now, 0, axis]


@inlined("repaired")
def _sweep(repaired: Floats, source: Floats, bar: Floats, first: int) -> None:
    for now in range(first, len(source) - 1):
        for marker in range(len(bar)):
            if _is_bad(source, bar[marker], now, marker):
                _to_midpoint(repaired, source, now, marker)


@inlined("track")
def _repair_worst_first(track: Floats, bar: float, first: int) -> None:
    """Repair one marker, (T, 1, 3), in place."""
    frames = len(track)
    done = np.zeros(frames, np.bool_)
    # The largest deviation first, of equals the earliest. What waits may be out of date: it
    # counts if it still holds when its turn comes, and what has changed waits once more.
    waiting = [(0.0, 0) for _ in range(0)]
    for now in range(first, frames - 1):
        if _is_bad(track, bar, now, 0):
            heappush(waiting, (-_deviation(track, now), now))
    while len(waiting):
        deviation, now = heappop(waiting)
        if done[now] or not _is_bad(track, bar, now, 0) or -deviation != _deviation(track, now):
            continue
        _to_midpoint(track, track, now, 0)
        done[now] = True
        for beside in range(max(now - 1, first), min(now + 2, frames - 1)):
            if not done[beside] and _is_bad(track, bar, beside, 0):
                heappush(waiting, (-_deviation(track, beside), beside))


@kernel()
def bars(positions: Floats, factor: float) -> Floats:
    """Return (M,), the length from which a marker's step is long; infinite where none is.

    Parameters
    ----------
    positions : (T, M, 3) array of float64
    factor
        How many times the mean step is a long one.
    """
    frames, markers = positions.shape[:2]
    total, count = np.zeros(markers), np.zeros(markers)
    for now in range(1, frames):
        for marker in range(markers):
            step = _step(positions, now, marker)
            if step == step:
                total[marker] += step
                count[marker] += 1.0
    bar = np.full(markers, np.inf)
    for marker in range(markers):
        if total[marker] > 0.0:
            bar[marker] = factor * (total[marker] / count[marker])
    return bar


@inlined()
def _is_bad(positions: Floats, bar: float, now: int, marker: int) -> bool:
    long: bool = _step(positions, now, marker) >= bar and _step(positions, now + 1, marker) >= bar
    return long


@inlined()
def _step(positions: Floats, now: int, marker: int) -> float:
    """Return the distance of a sample from the one before it; NaN where one is missing."""
    x = positions[now, marker, 0] - positions[now - 1, marker, 0]
    y = positions[now, marker, 1] - positions[now - 1, marker, 1]
    z = positions[now, marker, 2] - positions[now - 1, marker, 2]
    return math.sqrt(x * x + y * y + z * z)


@inlined("repaired")
def _to_midpoint(repaired: Floats, positions: Floats, now: int, marker: int) -> None:
    for axis in range(3):
        before, after = positions[now - 1, marker, axis], positions[now + 1, marker, axis]
        repaired[now, marker, axis] = (before + after) / 2.0


@inlined()
def _deviation(track: Floats, now: int) -> float:
    """Return the distance of a sample from the midpoint of its neighbours."""
    x = track[now, 0, 0] - (track[now - 1, 0, 0] + track[now + 1, 0, 0]) / 2.0
    y = track[now, 0, 1] - (track[now - 1, 0, 1] + track[now + 1, 0, 1]) / 2.0
    z = track[now, 0, 2] - (track[now - 1, 0, 2] + track[now + 1, 0, 2]) / 2.0
    return math.sqrt(x * x + y * y + z * z)
