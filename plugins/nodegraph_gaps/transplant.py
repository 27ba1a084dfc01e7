"""Lay a real recording's gaps over another recording."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_gaps.places import free_places
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

    Runs = tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]
    """Marker, first frame, frame after the last."""

TRIES = 1000
"""Number of beginnings that are tried: more would take minutes in a long recording."""


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


@dataclass(frozen=True)
class RealPattern:
    """Gaps of G runs on K markers, in frames of the recording that they are meant for.

    Attributes
    ----------
    marker : (G,) array of int
        Index of the marker among the K, in the order of their first gaps.
    start : (G,) array of int
        First frame, counted from the first gap of all.
    length : (G,) array of int
        Frames.
    together : (K, K) array of int
        In how many frames of the source two markers are missing at once.
    """

    marker: NDArray[np.intp]
    start: NDArray[np.intp]
    length: NDArray[np.intp]
    together: NDArray[np.intp]

    @property
    def span(self) -> int:
        """Frames from the first one missing to the last."""
        return int((self.start + self.length).max())

    @property
    def markers(self) -> int:
        """Number of markers with gaps, K."""
        return len(self.together)


def read_pattern(source: Trajectories, rate: float) -> RealPattern:
    """Return the gaps of a recording, timed for another rate.

    Parameters
    ----------
    source
        Whose gaps. A sample that was filled counts as missing.
    rate
        Frames per second of the recording that the pattern is meant for.

    Raises
    ------
    ValueError
        If the source has no gap with a measured sample on each side.
    """
    marker, first, stop = _inner(source)
    columns, number = _in_order_of_appearance(marker)
    start, length = _timed(number, first, stop - first, rate / source.rate)
    gone = np.zeros(source.origin.shape, dtype=np.intp)
    for column, begin, end in zip(marker, first, stop, strict=True):
        gone[begin:end, column] = 1
    return RealPattern(number, start, length, gone[:, columns].T @ gone[:, columns])


def _inner(source: Trajectories) -> Runs:
    """Return the gaps with a measured sample on each side; say how many others there are."""
    marker, first, stop = _runs(~source.measured)
    inner = (first > 0) & (stop < source.frames)
    if not inner.any():
        raise ValueError(
            "pattern_from has no gap with a measured sample on each side: "
            f"{len(first)} runs of missing samples, {source.frames} frames of "
            f"{len(source.markers)} markers"
        )
    if not inner.all():
        warnings.warn(
            f"{np.count_nonzero(~inner)} of {len(first)} runs of missing samples of pattern_from "
            "reach the beginning or the end of its take and are left out",
            stacklevel=5,
        )
    return marker[inner], first[inner], stop[inner]


def _runs(missing: NDArray[np.bool_]) -> Runs:
    """Return the runs of True in (T, M), by first frame, then marker."""
    marker, first, stop = runs_of(missing)
    order = np.lexsort((marker, first))
    return marker[order], first[order], stop[order]


def _in_order_of_appearance(
    marker: NDArray[np.intp],
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    columns, place, number = np.unique(marker, return_index=True, return_inverse=True)
    order = np.argsort(place)
    return columns[order], np.argsort(order)[number]


def _timed(
    number: NDArray[np.intp], first: NDArray[np.intp], length: NDArray[np.intp], ratio: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return starts and lengths at another rate; gaps of one marker do not come to touch."""
    lengths = np.maximum(np.rint(length * ratio), 1).astype(np.intp)
    starts = np.rint((first - first.min()) * ratio).astype(np.intp)
    free_from = np.zeros(number.max() + 1, dtype=np.intp)
    for gap, marker in enumerate(number):
        starts[gap] = max(starts[gap], free_from[marker])
        free_from[marker] = starts[gap] + lengths[gap] + 1
    return starts, lengths
