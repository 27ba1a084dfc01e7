from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import Detections


def _detections(**changes: object) -> Detections:
    given: dict[str, Any] = {"points": np.ones((3, 3)), "offsets": np.array([0, 2, 3]), "rate": 60}
    return Detections(**{**given, **changes})


def test_frames_are_counted_and_arrays_cannot_be_changed() -> None:
    detections = _detections(offsets=np.array([0, 2, 2, 3]))
    assert detections.frames == 3
    with pytest.raises(ValueError, match="read-only"):
        detections.points[0, 0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        detections.offsets[0] = 1


def test_a_recording_in_which_nothing_was_seen() -> None:
    empty = _detections(points=np.empty((0, 3)), offsets=np.zeros(4, dtype=int))
    assert empty.frames == 3


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points": np.ones((3, 2))}, r"points: must be \(points, 3\), got \(3, 2\)"),
        ({"points": np.full((3, 3), np.nan)}, r"points: missing \(NaN\) at \(0, 0\)"),
        ({"points": np.full((3, 3), np.inf)}, "points: infinite"),
        ({"offsets": np.array([0, 2])}, "number of points, 3"),
        ({"offsets": np.array([1, 3])}, "must go from 0"),
        ({"offsets": np.array([], dtype=int)}, "must go from 0"),
        ({"offsets": np.array([0, 3, 1, 3])}, "fall after frame 1"),
        ({"offsets": np.array([0.0, 3.0])}, "whole numbers, got float64"),
        ({"offsets": np.array([0, 4])}, "must lie in 0 to 3"),
        ({"rate": 0.0}, "rate must be from 0.001 to 1e6 frames"),
        ({"rate": 1e300}, "rate must be from 0.001 to 1e6 frames"),
        ({"rate": float("nan")}, "rate must be from 0.001 to 1e6 frames"),
    ],
)
def test_bad_detections_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _detections(**changes)
