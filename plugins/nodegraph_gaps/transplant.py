"""Lay a real recording's gaps over another recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_gaps.places import free_places
from nodegraph_gaps.real_pattern import read_pattern
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_gaps.real_pattern import RealPattern
    from nodegraph_mocap import Trajectories

TRIES = 1000
"""How many beginnings are tried, so that an error does not take minutes in a long recording."""


def transplanted(
    recording: Trajectories, source: Trajectories, random: np.random.Generator
) -> NDArray[np.bool_]:
    """Return which samples the gaps of another recording hide, (T, M).

    Parameters
    ----------
    recording
        Where gaps are made.
    source
        Whose gaps.
    random
        The source of chance: when the pattern begins, and which marker stands for which.

    Raises
    ------
    ValueError
        If the source has no gaps, or they do not fit.
    """
    pattern = read_pattern(source, recording.rate)
    begins = 1 + random.permutation(max(recording.frames - pattern.span - 1, 0))
    free = {
        int(length): free_places(recording, int(length), at_end=False)
        for length in np.unique(pattern.length)
    }
    shape = reference_shape(recording)
    apart = np.linalg.norm(shape[:, None] - shape, axis=2)
    most = 0 if len(begins) else _most_within(pattern, recording.frames)
    for begin in begins[:TRIES].tolist():
        chosen = _markers(_fits(pattern, free, begin), pattern, apart, random)
        if (chosen >= 0).all():
            return _hidden(recording, pattern, begin, chosen)
        most = max(most, int(np.count_nonzero(chosen[pattern.marker] >= 0)))
    raise ValueError(
        f"{len(pattern.start)} gaps on {pattern.markers} markers within {pattern.span} frames are "
        f"the pattern, {most} fit into {recording.frames} frames of {len(recording.markers)} "
        "markers: take a longer or more complete recording, or a smaller pattern"
    )


def _fits(
    pattern: RealPattern, free: dict[int, NDArray[np.bool_]], begin: int
) -> NDArray[np.bool_]:
    """Return on which markers all gaps of each of the pattern's markers go, (K, M)."""
    fits = np.ones((pattern.markers, next(iter(free.values())).shape[1]), dtype=np.bool_)
    for marker, start, length in zip(
        pattern.marker.tolist(), pattern.start.tolist(), pattern.length.tolist(), strict=True
    ):
        fits[marker] &= free[length][begin + start]
    return fits


def _markers(
    fits: NDArray[np.bool_],
    pattern: RealPattern,
    apart: NDArray[np.float64],
    random: np.random.Generator,
) -> NDArray[np.intp]:
    """Return which marker stands for each of the pattern's, (K,); -1 where none is left.

    A marker that is missing at the same time as one before it goes next to that one.
    """
    chosen = np.full(len(fits), -1)
    for marker, fitting in enumerate(fits):
        left = np.setdiff1d(np.flatnonzero(fitting), chosen)
        if not len(left):
            continue
        shared = np.where(chosen >= 0, pattern.together[marker], 0)
        if shared.any():
            chosen[marker] = left[apart[chosen[shared.argmax()], left].argmin()]
        else:
            chosen[marker] = random.choice(left)
    return chosen


def _hidden(
    recording: Trajectories, pattern: RealPattern, begin: int, chosen: NDArray[np.intp]
) -> NDArray[np.bool_]:
    hidden = np.zeros(recording.origin.shape, dtype=np.bool_)
    for marker, start, length in zip(pattern.marker, pattern.start, pattern.length, strict=True):
        hidden[begin + start : begin + start + length, chosen[marker]] = True
    return hidden


def _most_within(pattern: RealPattern, frames: int) -> int:
    """Return how many gaps lie within as many frames, one left over on each side."""
    stop = pattern.start + pattern.length
    last = pattern.start[:, None] + max(frames - 2, 0)
    inside = (pattern.start >= pattern.start[:, None]) & (stop <= last)
    return int(inside.sum(axis=1).max())
