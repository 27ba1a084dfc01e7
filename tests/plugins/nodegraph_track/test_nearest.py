"""The nearest pair is linked first, from the last position, whatever the motion was."""

from __future__ import annotations

import numpy as np

from nodegraph_mocap import Detections
from nodegraph_track.nearest import nearest


def test_no_motion_is_predicted() -> None:
    # 2 mm per frame, hidden in frame 4: it reappears 4 mm from its last position
    where = np.array([0.0, 2, 4, 6, 10, 12, 14])
    points = np.column_stack([where, 0 * where, 0 * where])
    offsets = np.array([0, 1, 2, 3, 4, 4, 5, 6, 7])
    detections = Detections(points=points, offsets=offsets, rate=60.0)
    assert len(nearest(detections, gate=3.0).markers) == 2
    assert len(nearest(detections, gate=4.0).markers) == 1


def test_the_nearer_track_takes_the_point() -> None:
    points = np.array([[0.0, 0, 0], [3, 0, 0], [2, 0, 0]])
    tracks = nearest(
        Detections(points=points, offsets=np.array([0, 2, 3]), rate=60.0), gate=5.0, shortest=1
    )
    assert tracks.positions[1, 1, 0] == 2.0
    assert not tracks.present[1, 0]
