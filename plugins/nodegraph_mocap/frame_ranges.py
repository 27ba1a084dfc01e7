"""Ranges of frames: runs in which something holds of a marker, and chunks of a long recording."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

# a chunk that has just been touched is still in the processor's cache when it is touched again
_CHUNK_BYTES = 2**19


class RunsOfTrue(NamedTuple):
    """Runs of True, ordered by marker and then by time.

    Attributes
    ----------
    marker, start, stop : (R,) arrays of int
        Frames ``start`` to ``stop - 1`` of the marker are True, the frames around are not.
    """

    marker: NDArray[np.intp]
    start: NDArray[np.intp]
    stop: NDArray[np.intp]

    def longest(self, markers: int) -> NDArray[np.intp]:
        """Return the frames of the longest run of each of so many markers, 0 without any."""
        longest = np.zeros(markers, dtype=np.intp)
        np.maximum.at(longest, self.marker, self.stop - self.start)
        return longest

    def by_start(self) -> RunsOfTrue:
        """Return the runs ordered by their first frame, then by marker, as gaps are numbered."""
        order = np.lexsort((self.marker, self.start))
        return RunsOfTrue(*(column[order] for column in self))


def runs_of(flags: NDArray[np.bool_]) -> RunsOfTrue:
    """Return the runs of True in (T, M), or in (T,) as of one marker."""
    columns = np.atleast_2d(flags.T)
    markers, frames = columns.shape
    padded = np.zeros((markers, frames + 2), dtype=np.bool_)
    padded[:, 1:-1] = columns
    edges = np.flatnonzero(padded[:, 1:] != padded[:, :-1])
    marker, start = np.divmod(edges[::2], frames + 1)
    return RunsOfTrue(marker, start, edges[1::2] % (frames + 1))


def chunks(frames: int, frame_bytes: int) -> Iterator[slice]:
    """Yield slices that together are all frames, in their order.

    What is computed from a long recording chunk by chunk takes little memory.

    Parameters
    ----------
    frames
        Number of frames.
    frame_bytes
        Bytes of one frame; each slice has about half a megabyte, and one frame at least.
    """
    step = max(1, _CHUNK_BYTES // max(1, frame_bytes))
    for first in range(0, frames, step):
        yield slice(first, min(first + step, frames))
