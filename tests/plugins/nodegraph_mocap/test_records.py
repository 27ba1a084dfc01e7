"""Recordings, detections, heads, models, weights, motions and selections refuse contradictions."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import (
    BlendshapeModel,
    Detections,
    Head,
    HeadMotion,
    Mask,
    Selection,
    Trajectories,
    Weights,
    nodegraph_kinds,
)

NAN, INF = float("nan"), float("inf")
STILL = np.tile(np.eye(3), (4, 1, 1))
HALF_MISSING = np.ones((4, 2, 3))
HALF_MISSING[1, 0] = NAN
GOOD: dict[type, dict[str, Any]] = {
    Trajectories: {"positions": HALF_MISSING, "markers": ("a", "b"), "rate": 60},
    Detections: {"points": np.ones((3, 3)), "offsets": np.array([0, 2, 2, 3]), "rate": 60},
    Mask: {"hidden": np.array([[0, 1], [1, 0]]), "markers": ("a", "b")},
    HeadMotion: {"rotations": STILL, "translations": np.zeros((4, 3)), "scales": np.ones(4)},
    BlendshapeModel: {
        "neutral": np.zeros((2, 3)),
        "shapes": np.ones((3, 2, 3)),
        "names": ("smile", "frown", "blink"),
        "markers": ("a", "b"),
    },
    Weights: {"values": np.full((4, 2), NAN), "names": ("smile", "frown"), "rate": 60.0},
    Head: {
        "vertices": np.arange(12.0).reshape(4, 3),
        "faces": np.array([[0, 1, 2], [1, 3, 2]]),
        "morphs": np.zeros((1, 4, 3)),
        "names": ("smile",),
        "markers": ("a", "b"),
        "marker_vertices": np.array([3, 0]),
    },
    Selection: {
        "chosen": ("m", "r"),
        "pairs": (("l", "r"), ("m",)),
        "frequencies": np.array([0.5, 1.0]),
        "columns": ("k", "markers"),
        "history": np.array([[5.0, 2.0], [6.0, NAN]]),
    },
}

RATE = "rate must be from 0.001 to 1e6 frames per second, got"
BAD: list[tuple[type, dict[str, object], str]] = [
    (Trajectories, {"positions": np.ones((4, 2))}, r"\(frames, 2 markers, 3\), got \(4, 2\)"),
    (Trajectories, {"positions": np.ones((4, 3, 3))}, r"got \(4, 3, 3\)"),
    (Trajectories, {"markers": ("a", "a")}, "named twice: a"),
    (Trajectories, {"markers": ("a", 1)}, "markers: names are texts, not 1"),
    (Trajectories, {"rate": 0}, f"{RATE} 0"),
    (Trajectories, {"rate": NAN}, f"{RATE} nan"),
    (Trajectories, {"rate": INF}, f"{RATE} inf"),
    (Trajectories, {"origin": np.ones((4, 3))}, r"origin must be \(4, 2\), got \(4, 3\)"),
    (Trajectories, {"origin": np.ones((4, 2))}, "exactly the missing samples missing"),
    (Trajectories, {"origin": np.zeros((4, 2))}, "exactly the missing samples missing"),
    (Trajectories, {"origin": np.array([[1, 1], [0, 4], [1, 1], [1, 1]])}, "others 1 to 3"),
    (Trajectories, {"marker_set": "face"}, "marker_set must be a MarkerSet, got 'face'"),
    (Trajectories, {"sigma": np.ones((4, 2, 3))}, r"sigma must be \(4, 2\), got \(4, 2, 3\)"),
    (Detections, {"points": np.ones((3, 2))}, r"points: must be \(points, 3\), got \(3, 2\)"),
    (Detections, {"points": np.full((3, 3), NAN)}, r"points: missing \(NaN\) at \(0, 0\)"),
    (Detections, {"points": np.full((3, 3), INF)}, "points: infinite"),
    (Detections, {"offsets": np.array([0, 2])}, "number of points, 3"),
    (Detections, {"offsets": np.array([1, 3])}, "must go from 0"),
    (Detections, {"offsets": np.array([], dtype=int)}, "must go from 0"),
    (Detections, {"offsets": np.array([0, 3, 1, 3])}, "fall after frame 1"),
    (Detections, {"offsets": np.array([0.0, 3.0])}, "whole numbers, got float64"),
    (Detections, {"offsets": np.array([0, 4])}, "must lie in 0 to 3"),
    (Detections, {"rate": 1e300}, RATE),
    (Mask, {"markers": ("a",)}, r"\(frames, 1 markers\), got \(2, 2\)"),
    (HeadMotion, {"rotations": np.ones((4, 3))}, r"rotations: must be \(frames, 3, 3\)"),
    (HeadMotion, {"rotations": 2 * STILL}, "frame 0 is not orthonormal"),
    (HeadMotion, {"translations": np.zeros((3, 3))}, r"translations: must be \(4, 3\), got"),
    (HeadMotion, {"translations": np.full((4, 3), NAN)}, "missing"),
    (HeadMotion, {"scales": np.ones(3)}, r"scales: must be \(4\)"),
    (HeadMotion, {"scales": np.array([1, 0, 1, 1])}, "must be positive, got 0.0 in frame 1"),
    (BlendshapeModel, {"neutral": np.zeros((3, 3))}, r"neutral: must be \(2, 3\)"),
    (BlendshapeModel, {"neutral": np.full((2, 3), NAN)}, "neutral: missing"),
    (BlendshapeModel, {"shapes": np.ones((2, 2, 3))}, r"shapes: must be \(3, 2, 3\), got"),
    (BlendshapeModel, {"shapes": np.full((3, 2, 3), INF)}, "shapes: infinite"),
    (BlendshapeModel, {"names": ("smile", "smile", "a")}, "shape names: named twice: smile"),
    (BlendshapeModel, {"markers": ("a", "a")}, "markers: named twice: a"),
    (Weights, {"values": np.zeros((4, 3))}, r"weights: must be \(frames, 2\), got \(4, 3\)"),
    (Weights, {"values": np.full((4, 2), INF)}, r"weights: infinite at \(0, 0\)"),
    (Weights, {"names": ("smile", "smile")}, "named twice: smile"),
    (Weights, {"rate": -1.0}, RATE),
    (Head, {"vertices": np.zeros((4, 2))}, r"vertices: must be \(vertices, 3\)"),
    (Head, {"vertices": np.full((4, 3), NAN)}, "vertices: missing"),
    (Head, {"faces": np.array([[0, 1, 4]])}, "faces: must lie in 0 to 3, got 0 to 4"),
    (Head, {"faces": np.array([[0, -1, 2]])}, "faces: must lie in 0 to 3"),
    (Head, {"faces": np.array([[0.0, 1.0, 2.0]])}, "faces: must be whole numbers"),
    (Head, {"faces": np.array([[0, 1, 2, 3]])}, r"faces: must be \(triangles, 3\)"),
    (Head, {"morphs": np.zeros((1, 3, 3))}, r"morphs: must be \(1, 4, 3\), got \(1, 3, 3\)"),
    (Head, {"names": ("a", "a")}, "morph targets: named twice: a"),
    (Head, {"markers": ("a", "a")}, "markers: named twice: a"),
    (Head, {"marker_vertices": np.array([3])}, r"marker vertices: must be \(2\), got \(1,\)"),
    (Head, {"marker_vertices": np.array([3, 4])}, "marker vertices: must lie in 0 to 3"),
    (Selection, {"chosen": ("m", "m")}, "chosen markers: named twice: m"),
    (Selection, {"chosen": ("x", "m")}, "chosen, but in no pair: x"),
    (Selection, {"pairs": (("m",), ("m",))}, "pairs: named twice: m"),
    (Selection, {"pairs": (("m",), ())}, "pairs: number 1 holds no marker"),
    (Selection, {"frequencies": np.array([1.0])}, r"frequencies: must be \(2\)"),
    (Selection, {"frequencies": np.array([1.0, 1.5])}, "must be shares, 0 to 1"),
    (Selection, {"frequencies": np.array([1.0, NAN])}, "missing"),
    (Selection, {"history": None}, "columns k, markers without a history"),
    (Selection, {"columns": ("k",)}, r"history: must be \(rows, 1\)"),
]


@pytest.mark.parametrize(("kind", "changed", "message"), BAD)
def test_contradictions_are_refused(kind: type, changed: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        kind(**GOOD[kind] | changed)


SPECIMENS = {kind.type: kind.specimens() for kind in nodegraph_kinds() if kind.specimens}


@pytest.mark.parametrize("kind", SPECIMENS)
def test_arrays_are_read_only(kind: type) -> None:
    given = GOOD.get(kind, {})
    for record in (*SPECIMENS[kind].values(), *([kind(**given)] if given else [])):
        for field in fields(record):
            array = getattr(record, field.name)
            assert not isinstance(array, np.ndarray) or not array.flags.writeable


def test_frames_are_counted_whether_or_not_something_was_seen() -> None:
    assert Detections(**GOOD[Detections]).frames == 3
    empty = Detections(points=np.empty((0, 3)), offsets=np.zeros(4, dtype=int), rate=60)
    assert empty.frames == 3
    assert HeadMotion(**GOOD[HeadMotion]).frames == Weights(**GOOD[Weights]).frames == 4


def test_a_mirror_image_is_a_head_motion_as_alignment_may_find_one() -> None:
    mirror = np.tile(np.diag([-1.0, 1.0, 1.0]), (4, 1, 1))
    motion = HeadMotion(**GOOD[HeadMotion] | {"rotations": mirror})
    np.testing.assert_array_equal(motion.rotations, mirror)


def test_markers_alone_make_a_selection() -> None:
    result = Selection(chosen=("a",))
    assert (result.pairs, result.frequencies, result.history) == ((), None, None)
