"""Runs of present samples, and what every smoothing does with them.

A gap splits a marker's trajectory into runs. Each run is smoothed by itself, however short, so
that nothing is carried across a gap, no sample is added and none is lost. What is measured,
filled or repaired stays so called.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal, Window
from nodegraph_mocap import MarkerFrame, Trajectories
from nodegraph_mocap.frame_ranges import RunsOfTrue, runs_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TOGETHER = 2_000_000
"""Samples that are smoothed at once, so that a long take needs little memory beside itself."""


@dataclass(frozen=True)
class Smoothing:
    """A recording that is smoothed.

    Attributes
    ----------
    recording
        Trajectories, with or without gaps.

    Returns
    -------
    Trajectories
        The recording with other positions; `sigma`, if it has any, NaN where they differ.
    """

    recording: Trajectories


Method = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
"""Smooths runs of one length, (L, G, 3) mm relative to their first samples, along their frames."""


class Runs(RunsOfTrue):
    """Runs of present samples of one marker."""

    __slots__ = ()

    @staticmethod
    def of(recording: Trajectories) -> Runs:
        """Return the runs of a recording."""
        present = recording.present
        frames, markers = present.shape
        if frames and present.all():
            every = np.arange(markers)
            return Runs(every, np.zeros_like(every), np.full_like(every, frames))
        return Runs(*runs_of(present))

    @property
    def length(self) -> NDArray[np.intp]:
        """(R,) frames."""
        return self.stop - self.start

    def subset(self, which: NDArray[np.generic]) -> Runs:
        """Return some of the runs."""
        return Runs(self.marker[which], self.start[which], self.stop[which])

    def by_length(self) -> Iterator[tuple[int, Runs]]:
        """Yield the runs of each length, the shortest first."""
        for length in np.unique(self.length):
            yield int(length), self.subset(self.length == length)

    def together(self, most: int) -> Iterator[Runs]:
        """Yield equally long runs, some at a time: up to `most` samples, but one run at least."""
        some = max(1, most // int(self.length[0]))
        for first in range(0, len(self.start), some):
            part = slice(first, first + some)
            yield Runs(self.marker[part], self.start[part], self.stop[part])

    def samples(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return frame and marker of each sample of runs that are equally long, (L, R) each."""
        frame = self.start + np.arange(self.length[0])[:, None]
        return frame, np.broadcast_to(self.marker, frame.shape)


def smooth_runs(recording: Trajectories, method: Method, *, shortest: int = 1) -> Trajectories:
    """Smooth each run by itself, and warn of what is left as it was; called by a node.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.
    method
        Is given runs of one length, many at once.
    shortest
        Runs of fewer frames stay as they are.

    Returns
    -------
    Trajectories
        The recording with other positions.

    Raises
    ------
    Refusal
        If there are runs and all of them are shorter than `shortest`.
    """
    runs = long_enough(Runs.of(recording), shortest)
    positions = recording.positions.copy()
    for _, alike in runs.by_length():
        for some in alike.together(_TOGETHER):
            where = some.samples()
            block = positions[where]
            # The same run elsewhere in space then gives the same numbers, and a still one itself.
            positions[where] = block[0] + method(block - block[0])
    return smoothed(recording, positions)


def long_enough(runs: Runs, shortest: int) -> Runs:
    """Return the runs of at least `shortest` frames, and warn of the others; called by a helper.

    Raises
    ------
    Refusal
        If there are runs and all of them are shorter.
    """
    if not len(runs.start):
        warnings.warn("no sample is present: there is nothing to smooth", stacklevel=5)
        return runs
    short = runs.length < shortest
    if short.all():
        raise Refusal(
            f"needs {shortest} frames in a row; the longest run of present samples has "
            f"{runs.length.max()}"
        )
    if short.any():
        warnings.warn(
            f"{np.count_nonzero(short)} of {len(short)} runs of present samples "
            f"({runs.length[short].sum()} samples) are shorter than {shortest} frames and stay "
            "as they were",
            stacklevel=5,
        )
    return runs.subset(~short)


def smoothed(recording: Trajectories, positions: NDArray[np.float64]) -> Trajectories:
    """Return the recording with smoothed positions.

    Origins stay. So does the sigma of samples that stayed as they were; of the others it is NaN,
    as it was that of the samples before.
    """
    if recording.sigma is None:
        return replace(recording, positions=positions)
    moved = np.any(positions != recording.positions, axis=2)
    return replace(recording, positions=positions, sigma=np.where(moved, np.nan, recording.sigma))


def smoothed_at(
    window: Window[MarkerFrame, Trajectories],
    smooth_into: Callable[[NDArray[np.float64], NDArray[np.float64], Runs], None],
) -> MarkerFrame:
    """Return the frame of a window that is computed, as its runs are smoothed.

    Parameters
    ----------
    window
        So long that what is beyond it changes nothing there.
    smooth_into
        ``smooth_into(out, positions, runs)`` writes the smoothed runs of (T, M, 3) positions.
    """
    from nodegraph_smooth import weights_kernel

    frames, now = window.frames, window.frames.at(window.now)
    out = np.empty_like(frames.positions)
    smooth_into(out, frames.positions, Runs(*weights_kernel.runs_of(frames.present)))
    positions, sigma = out[window.now].copy(), now.sigma
    if sigma is not None:
        sigma = np.where(np.any(positions != now.positions, axis=1), np.nan, sigma)
    return MarkerFrame(positions, now.origin.copy(), sigma)
