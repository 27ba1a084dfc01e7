from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import Head


def _head(**changes: object) -> Head:
    given: dict[str, Any] = {
        "vertices": np.arange(12.0).reshape(4, 3),
        "faces": np.array([[0, 1, 2], [1, 3, 2]]),
        "morphs": np.zeros((1, 4, 3)),
        "names": ("smile",),
        "markers": ("a", "b"),
        "marker_vertices": np.array([3, 0]),
    }
    return Head(**{**given, **changes})


def test_arrays_cannot_be_changed() -> None:
    head = _head()
    for array in (head.vertices, head.faces, head.morphs, head.marker_vertices):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"vertices": np.zeros((4, 2))}, r"vertices: must be \(vertices, 3\)"),
        ({"vertices": np.full((4, 3), np.nan)}, "vertices: missing"),
        ({"faces": np.array([[0, 1, 4]])}, "faces: must lie in 0 to 3, got 0 to 4"),
        ({"faces": np.array([[0, -1, 2]])}, "faces: must lie in 0 to 3"),
        ({"faces": np.array([[0.0, 1.0, 2.0]])}, "faces: must be whole numbers"),
        ({"faces": np.array([[0, 1, 2, 3]])}, r"faces: must be \(triangles, 3\)"),
        ({"morphs": np.zeros((1, 3, 3))}, r"morphs: must be \(1, 4, 3\), got \(1, 3, 3\)"),
        ({"names": ("smile", "smile")}, "morph targets: named twice: smile"),
        ({"markers": ("a", "a")}, "markers: named twice: a"),
        ({"marker_vertices": np.array([3])}, r"marker vertices: must be \(2\), got \(1,\)"),
        ({"marker_vertices": np.array([3, 4])}, "marker vertices: must lie in 0 to 3"),
    ],
)
def test_a_bad_head_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _head(**changes)
