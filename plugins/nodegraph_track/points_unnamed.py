"""Points without names, as a camera system without labels gives them."""

from __future__ import annotations

import numpy as np

from nodegraph import FrameForm, node
from nodegraph_mocap import Detections, Trajectories


@node("points.unnamed", live=FrameForm())
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
