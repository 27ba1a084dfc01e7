"""Gaps of a recording as arrays, and the look-ahead of fills that stop at their ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from nodegraph import Unit
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.frame_ranges import runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

MaxGap = Annotated[int | None, Field(ge=1), Unit("frames")]
"""The setting ``max_gap``: longer gaps stay missing; None fills gaps of any length."""


def to_gap_end(settings: Mapping[str, Any]) -> int | None:
    """Return the look-ahead of a fill that needs the sample after a gap."""
    max_gap: int | None = settings["max_gap"]
    return max_gap


def to_limit(settings: Mapping[str, Any]) -> int:
    """Return the look-ahead of a fill that goes forward in time.

    Only a limit makes it look ahead: whether a gap is longer must be known before its first
    sample is filled. Gaps at the start of a take do not count.
    """
    return settings["max_gap"] or 0


@dataclass(frozen=True)
class Gaps:
    """Runs of missing samples of one marker, ordered by marker and then by time.

    Attributes
    ----------
    marker, start, stop : (G,) arrays of int
        Frames ``start`` to ``stop - 1`` of the marker are missing, the frames around are not.
    shape : (frames, markers)
    """

    marker: NDArray[np.intp]
    start: NDArray[np.intp]
    stop: NDArray[np.intp]
    shape: tuple[int, int]

    @staticmethod
    def of(recording: Trajectories) -> Gaps:
        """Return the gaps of a recording."""
        frames, markers = recording.origin.shape
        return Gaps(*runs_of(recording.origin == Origin.MISSING), (frames, markers))

    @property
    def length(self) -> NDArray[np.intp]:
        """(G,) frames."""
        return self.stop - self.start

    @property
    def at_start(self) -> NDArray[np.bool_]:
        """(G,), True where the marker is measured after the gap only."""
        return np.asarray((self.start == 0) & (self.stop < self.shape[0]))

    @property
    def at_end(self) -> NDArray[np.bool_]:
        """(G,), True where the marker is measured before the gap only."""
        return np.asarray((self.start > 0) & (self.stop == self.shape[0]))

    @property
    def never(self) -> NDArray[np.bool_]:
        """(G,), True where the gap is the whole take."""
        return np.asarray(self.length == self.shape[0])

    @property
    def inner(self) -> NDArray[np.bool_]:
        """(G,), True where the marker is measured before and after the gap."""
        return np.asarray((self.start > 0) & (self.stop < self.shape[0]))

    def beside(
        self, positions: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return what positions (T, M, 3) have before and after each gap, (G, 3) each.

        It is NaN beyond the take.
        """
        frame = np.stack([self.start - 1, self.stop])
        within = (frame >= 0) & (frame < self.shape[0])
        there = positions[np.where(within, frame, 0), self.marker]
        before, after = np.where(within[..., None], there, np.nan)
        return before, after

    def longer_than(self, frames: int | None) -> NDArray[np.bool_]:
        """(G,), True where the gap is longer; nowhere when there is no limit."""
        return np.zeros(len(self.start), dtype=np.bool_) if frames is None else self.length > frames

    def subset(self, which: NDArray[np.bool_]) -> Gaps:
        """Return some of the gaps."""
        return Gaps(self.marker[which], self.start[which], self.stop[which], self.shape)

    def joined(self, others: Gaps) -> Gaps:
        """Return these gaps and others of the same recording, in their order."""
        marker, start, stop = (
            np.concatenate(pair)
            for pair in (
                (self.marker, others.marker),
                (self.start, others.start),
                (self.stop, others.stop),
            )
        )
        order = np.lexsort((start, marker))
        return Gaps(marker[order], start[order], stop[order], self.shape)

    @cached_property
    def mask(self) -> NDArray[np.bool_]:
        """(frames, markers), True where a sample lies in one of the gaps."""
        inside = np.zeros(self.shape, dtype=np.bool_)
        _, frame, marker, _ = self.samples
        inside[frame, marker] = True
        return inside

    @cached_property
    def samples(
        self,
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp], NDArray[np.float64]]:
        """Return, for every sample in a gap, its gap, frame, marker and share of the way.

        The share is j / (L + 1) at the j-th of a gap's L frames, counted from 1.
        """
        gap = np.repeat(np.arange(len(self.start)), self.length)
        first = np.cumsum(self.length) - self.length
        step = np.arange(len(gap)) - first[gap]
        share = (step + 1) / (self.length[gap] + 1)
        return gap, self.start[gap] + step, self.marker[gap], share
