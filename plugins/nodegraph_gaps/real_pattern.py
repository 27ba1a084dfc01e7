"""The gaps of a real recording, as a pattern for another one."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

    Runs = tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]
    """Marker, first frame, frame after the last."""


@dataclass(frozen=True)
class RealPattern:
    """Gaps of G runs on K markers, in frames of the recording that they are meant for.

    Attributes
    ----------
    marker : (G,) array of int
        Which of the K markers, in the order of their first gaps.
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
        """How many markers have gaps, K."""
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
