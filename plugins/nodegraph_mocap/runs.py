"""Runs: frames in a row in which something holds of a marker, such as being missing."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class RunsOfTrue(NamedTuple):
    """Every run of True, by marker and then by time.

    Attributes
    ----------
    marker, start, stop : (R,) arrays of int
        Frames ``start`` to ``stop - 1`` of the marker are True, the frames around are not.
    """

    marker: NDArray[np.intp]
    start: NDArray[np.intp]
    stop: NDArray[np.intp]


def runs_of(flags: NDArray[np.bool_]) -> RunsOfTrue:
    """Return the runs of True in (T, M), or in (T,) as of one marker."""
    columns = np.atleast_2d(flags.T)
    markers, frames = columns.shape
    padded = np.zeros((markers, frames + 2), dtype=np.bool_)
    padded[:, 1:-1] = columns
    edges = np.flatnonzero(padded[:, 1:] != padded[:, :-1])
    marker, start = np.divmod(edges[::2], frames + 1)
    return RunsOfTrue(marker, start, edges[1::2] % (frames + 1))
