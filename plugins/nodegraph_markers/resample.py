"""Another frame rate."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SAME = 1e-6
"""Frames: instants that are nearer than this are the same."""


@node("recording.resample", cite="deboor1978", lookahead=None)
def resample(
    recording: Trajectories,
    *,
    rate: Annotated[float, Field(gt=0, allow_inf_nan=False), Unit("Hz")],
) -> Trajectories:
    """Give a recording another frame rate, by cubic splines through its samples.

    Output frame j lies at ``j / rate`` seconds, from the first frame to the last that is not
    after the take's end. Where a source frame lies at that instant, its samples are handed on
    bit for bit, with their origin. In between, each uninterrupted run of a marker's present
    samples is interpolated by a cubic spline with not-a-knot ends (a parabola through three
    samples, a line through two) [1]_. A sample between two source frames of which one is missing
    is missing: no gap is bridged.

    A made sample has the origin of the two source samples beside it, where they differ the less
    trusted one: repaired before filled before measured. `sigma` is interpolated linearly.

    At a lower rate nothing is filtered first: movement and noise faster than half the new rate
    fold into slower ones, as a warning says. Smooth before, where that matters.

    Looks ahead to the end of the run: every sample bears on a spline.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    rate
        Frames per second of the result. The recording's own returns it as it is.

    Returns
    -------
    Trajectories
        ``floor((T - 1) rate / recording.rate) + 1`` frames.

    References
    ----------
    .. [1] C. de Boor, A Practical Guide to Splines, Springer 1978, ch. IV.
    """
    if rate == recording.rate or not recording.frames:
        return replace(recording, rate=rate)
    if rate < recording.rate:
        warnings.warn(
            f"from {recording.rate:g} to {rate:g} Hz without a filter: what is faster than "
            f"{rate / 2:g} Hz folds into slower movement",
            stacklevel=2,
        )
    places = _places(recording, rate)
    before = np.minimum(places.astype(np.intp), recording.frames - 1)
    after = np.minimum(before + 1, recording.frames - 1)
    # at a source frame itself, both sides are that frame
    after = np.where(places == before, before, after)
    there = recording.present[before] & recording.present[after]
    positions = _between(recording, places, there)
    exact = places == before
    positions[exact] = recording.positions[before[exact]]
    origin = np.maximum(recording.origin[before], recording.origin[after])
    return Trajectories(
        positions=positions,
        markers=recording.markers,
        rate=rate,
        marker_set=recording.marker_set,
        origin=np.where(there, origin, np.uint8(0)),
        sigma=_sigma(recording, places, before, after),
    )


def _places(recording: Trajectories, rate: float) -> NDArray[np.float64]:
    """Return the times of the output frames, in source frames; integers where they coincide."""
    step = recording.rate / rate
    count = math.floor((recording.frames - 1) / step + _SAME) + 1
    places = np.arange(count) * step
    whole = np.round(places)
    return np.where(np.abs(places - whole) < _SAME, whole, places)


def _between(
    recording: Trajectories, places: NDArray[np.float64], there: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return the splines' values at the places, (F, M, 3), NaN where `there` is False."""
    from scipy.interpolate import CubicSpline

    positions = np.full((*there.shape, 3), np.nan)
    for (start, stop), markers in _runs(recording.present).items():
        inside = slice(*np.searchsorted(places, [start, stop - 1 + _SAME]))
        if stop - start > 1 and inside.start < inside.stop:
            spline = CubicSpline(np.arange(start, stop), recording.positions[start:stop, markers])
            positions[inside, markers] = spline(places[inside])
    return positions


def _runs(present: NDArray[np.bool_]) -> dict[tuple[int, int], list[int]]:
    """Return, for each run of present samples, first frame and end, which markers have it."""
    runs: dict[tuple[int, int], list[int]] = {}
    for marker, first, end in zip(*(part.tolist() for part in runs_of(present)), strict=True):
        runs.setdefault((first, end), []).append(marker)
    return runs


def _sigma(
    recording: Trajectories,
    places: NDArray[np.float64],
    before: NDArray[np.intp],
    after: NDArray[np.intp],
) -> NDArray[np.float64] | None:
    if recording.sigma is None:
        return None
    part = (places - before)[:, np.newaxis]
    low, high = recording.sigma[before], recording.sigma[after]
    return np.asarray(np.where(part > 0, (1 - part) * low + part * high, low))
