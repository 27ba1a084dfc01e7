"""Points without names, as a camera system without labels gives them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import StateForm, node
from nodegraph_mocap import Detections, MarkerFrame, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


class _Stream:
    """The points frame by frame."""

    def __init__(self, recording: Trajectories) -> None:
        self.header = unnamed(recording)

    def push(self, frame: MarkerFrame) -> NDArray[np.float64]:
        from nodegraph_track import tracks_kernel

        return tracks_kernel.in_order(frame.positions[frame.present])

    def drain(self) -> Iterable[NDArray[np.float64]]:
        return ()


@node("points.unnamed", live=StateForm(_Stream, lookahead=0))
def unnamed(recording: Trajectories) -> Detections:
    """Take the names off a recording's points, and leave all else as it is.

    `points.scatter` drops points, adds ghosts and shuffles them besides, over a whole take.

    Parameters
    ----------
    recording
        Trajectories, with or without gaps.

    Returns
    -------
    Detections
        Of each frame the samples that are present, by x, then y, then z.
    """
    frame, marker = np.nonzero(recording.present)
    points = recording.positions[frame, marker]
    counts = recording.present.sum(axis=1)
    return Detections(
        points=points[np.lexsort((*points.T[::-1], frame))],
        offsets=np.concatenate([[0], np.cumsum(counts)]),
        rate=recording.rate,
    )
