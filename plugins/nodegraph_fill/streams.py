"""Gaps of a stream: which are too long, and what fills each when the sample after it arrives."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import StateForm
from nodegraph_fill.gaps import Gaps, to_gap_end
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

Between = Callable[[Trajectories, Gaps], "NDArray[np.float64]"]
"""Returns the positions of the gaps' samples, (S, 3) mm, in the order of `Gaps.samples`; NaN where
it has none. A gap's depend on nothing but the frames from the one before to the one after it."""


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
        missing = frame.origin == Origin.MISSING
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

    def state(recording: Trajectories, *, ends: object, max_gap: int, **settings: Any) -> _Stream:
        return _Stream(recording, between(**settings), max_gap, one_end=one_end)

    return StateForm(state, lookahead=to_gap_end)


class _Stream:
    """Holds each frame for `max_gap` frames, by when its gaps are filled or too long."""

    def __init__(
        self, recording: Trajectories, between: Between, max_gap: int, *, one_end: bool
    ) -> None:
        self.header = recording
        self._between = between
        self._max_gap = max_gap
        self._one_end = one_end
        self._frames: deque[MarkerFrame] = deque(maxlen=max_gap + 2)
        """As they came: a gap and the frames on both sides of it."""
        self._waiting: deque[MarkerFrame] = deque()
        self._missing = np.zeros(len(recording.markers), dtype=np.intp)
        """Frames since each marker was last present, or since the stream began."""
        self._count = 0

    def push(self, frame: MarkerFrame) -> MarkerFrame | None:
        self._frames.append(frame)
        self._waiting.append(frame)
        missing = frame.origin == Origin.MISSING
        closed = ~missing & (self._missing > 0) & (self._missing <= self._max_gap)
        if not self._one_end:
            closed &= self._missing < self._count
        if closed.any():
            self._fill(np.flatnonzero(closed), len(self._frames) - 1)
        self._missing = np.where(missing, self._missing + 1, 0)
        self._count += 1
        return self._waiting.popleft() if len(self._waiting) > self._max_gap else None

    def drain(self) -> Iterable[MarkerFrame]:
        if self._one_end:
            at_end = (self._missing > 0) & (self._missing <= self._max_gap)
            at_end &= self._missing < self._count
            if at_end.any():
                self._fill(np.flatnonzero(at_end), len(self._frames))
        return self._waiting

    def _fill(self, markers: NDArray[np.intp], stop: int) -> None:
        """Fill the gaps of some markers that reach to a place among the last frames."""
        recording = replace(
            self.header,
            positions=np.stack([frame.positions for frame in self._frames]),
            origin=np.stack([frame.origin for frame in self._frames]),
            sigma=None,
        )
        stops = np.full_like(markers, stop)
        gaps = Gaps(markers, stops - self._missing[markers], stops, recording.origin.shape)
        values = self._between(recording, gaps)
        _, places, column, _ = gaps.samples
        known = ~np.isnan(values[:, 0])
        first = len(self._waiting) - len(self._frames)
        for place in np.unique(places[known]):
            here = known & (places == place)
            positions, origin, sigma = self._waiting[first + place]
            positions, origin = positions.copy(), origin.copy()
            positions[column[here]], origin[column[here]] = values[here], Origin.FILLED
            self._waiting[first + place] = MarkerFrame(positions, origin, sigma)
