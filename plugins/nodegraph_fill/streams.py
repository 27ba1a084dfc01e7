"""Gaps of a stream: which are too long, and what fills each when the sample after it arrives."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import StateForm
from nodegraph_fill.gaps import Gaps, to_gap_end
from nodegraph_fill.tuning import unless_tuned
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Between = Callable[[NDArray[np.float64], Gaps], NDArray[np.float64]]
    """Takes positions (T, M, 3) mm, NaN where missing, and gaps; returns the positions of their
    samples, (S, 3), in the order of `Gaps.samples`, NaN where it has none."""


class Limit:
    """Holds frames until it is known which of their gaps are longer than `max_gap`.

    Parameters
    ----------
    markers
        How many there are.
    max_gap
        None: no gap is too long, and no frame is held.
    """

    def __init__(self, markers: int, max_gap: int | None) -> None:
        self._max_gap = max_gap
        self._missing = np.zeros(markers, dtype=np.intp)
        """Frames since each marker was last present, at the newest frame."""
        self._held: deque[tuple[MarkerFrame, NDArray[np.bool_]]] = deque()

    def push(self, frame: MarkerFrame) -> tuple[MarkerFrame, NDArray[np.bool_]] | None:
        """Take the next frame; return the one `max_gap` before it, and what is to be filled."""
        missing = ~frame.present
        if self._max_gap is None:
            return frame, missing
        self._missing = np.where(missing, self._missing + 1, 0)
        for marker in np.flatnonzero(self._missing == self._max_gap + 1):
            for _, earlier in self._held:
                earlier[marker] = False
        self._held.append((frame, missing & (self._missing <= self._max_gap)))
        return self._held.popleft() if len(self._held) > self._max_gap else None

    def drain(self) -> Iterator[tuple[MarkerFrame, NDArray[np.bool_]]]:
        """Yield the frames that are left."""
        while self._held:
            yield self._held.popleft()


def live_form(between: Callable[..., Between], *, one_end: bool = False) -> StateForm:
    """Return how a fill between the two ends of a gap computes frame by frame.

    Parameters
    ----------
    between
        ``between(**settings)`` returns what fills gaps, in whole takes too.
    one_end
        Whether it fills a gap that the take begins or ends with.
    """

    def state(
        recording: Trajectories, *, ends: object, max_gap: int, settings: object, **own: object
    ) -> _Stream:
        return _Stream(recording, between(**own), max_gap, one_end=one_end)

    return StateForm(state, lookahead=unless_tuned(to_gap_end))


class _Stream:
    """Holds each frame for `max_gap` frames, by when its gaps are filled or too long."""

    def __init__(
        self, recording: Trajectories, between: Between, max_gap: int, *, one_end: bool
    ) -> None:
        markers = len(recording.markers)
        self.header = recording
        self._between = between
        self._max_gap = max_gap
        self._one_end = one_end
        self._reach = max_gap + 2
        """A gap and the frames on both sides of it."""
        self._positions = np.full((4 * self._reach, markers, 3), np.nan)
        """Positions of the last frames, as they came; the oldest are dropped when it is full."""
        self._stop = 0
        """Number of its frames in use."""
        self._waiting: deque[tuple[MarkerFrame, list[tuple[int, NDArray[np.float64]]]]] = deque()
        """Frames that are held, and the markers that are filled in them."""
        self._missing = np.zeros(markers, dtype=np.intp)
        """Frames since each marker was last present, or since the stream began."""
        self._count = 0

    def push(self, frame: MarkerFrame) -> MarkerFrame | None:
        if self._stop == len(self._positions):
            kept = self._reach - 1
            self._positions[:kept] = self._positions[-kept:]
            self._stop = kept
        self._positions[self._stop] = frame.positions
        self._stop += 1
        self._waiting.append((frame, []))
        present = frame.present
        self._fill(present, 1)
        self._missing += 1
        self._missing *= ~present
        self._count += 1
        return self._next() if len(self._waiting) > self._max_gap else None

    def drain(self) -> Iterable[MarkerFrame]:
        if self._one_end:
            self._fill(np.ones(len(self._missing), dtype=np.bool_), 0)
        return [self._next() for _ in range(len(self._waiting))]

    def _next(self) -> MarkerFrame:
        frame, fills = self._waiting.popleft()
        if not fills:
            return frame
        positions, origin = frame.positions.copy(), frame.origin.copy()
        for marker, position in fills:
            positions[marker], origin[marker] = position, Origin.FILLED
        return MarkerFrame(positions, origin, frame.sigma)

    def _fill(self, ended: NDArray[np.bool_], later: int) -> None:
        """Fill the gaps of some markers, which ended a number of frames ago."""
        ended = ended & (self._missing > 0) & (self._missing <= self._max_gap)
        (markers,) = np.nonzero(ended)
        lengths = self._missing[markers]
        # others began with the stream: they have one end, or none
        wanted = (lengths < self._count) | (self._one_end and later == 1)
        markers, lengths = markers[wanted], lengths[wanted]
        if not len(markers):
            return
        positions = self._positions[max(self._stop - self._reach, 0) : self._stop]
        stops = np.full_like(markers, len(positions) - later)
        gaps = Gaps(markers, stops - lengths, stops, positions.shape[:2])
        values = self._between(positions, gaps)
        _, places, columns, _ = gaps.samples
        places -= len(positions) - len(self._waiting)
        for place, marker, value in zip(places.tolist(), columns.tolist(), values, strict=True):
            if not np.isnan(value[0]):
                self._waiting[place][1].append((marker, value))
