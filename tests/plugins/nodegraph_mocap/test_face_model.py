from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from nodegraph_mocap import BlendshapeModel, HeadMotion, Weights


def _motion(**changes: object) -> HeadMotion:
    given: dict[str, Any] = {
        "rotations": np.tile(np.eye(3), (4, 1, 1)),
        "translations": np.zeros((4, 3)),
        "scales": np.ones(4),
    }
    return HeadMotion(**{**given, **changes})


def _model(**changes: object) -> BlendshapeModel:
    given: dict[str, Any] = {
        "neutral": np.zeros((2, 3)),
        "shapes": np.ones((3, 2, 3)),
        "names": ("smile", "frown", "blink"),
        "markers": ("a", "b"),
    }
    return BlendshapeModel(**{**given, **changes})


def _weights(**changes: object) -> Weights:
    given: dict[str, Any] = {"values": np.zeros((4, 2)), "names": ("smile", "frown"), "rate": 60.0}
    return Weights(**{**given, **changes})


def test_arrays_cannot_be_changed() -> None:
    for array in (_motion().rotations, _motion().scales, _model().shapes, _weights().values):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 2.0


def test_frames_are_counted() -> None:
    assert _motion().frames == 4
    assert _weights().frames == 4


def test_a_mirror_image_is_a_head_motion_as_alignment_may_find_one() -> None:
    mirror = np.tile(np.diag([-1.0, 1.0, 1.0]), (4, 1, 1))
    np.testing.assert_array_equal(_motion(rotations=mirror).rotations, mirror)


def test_a_weight_that_is_not_known_is_nan() -> None:
    assert np.isnan(_weights(values=np.full((4, 2), np.nan)).values).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rotations": np.ones((4, 3))}, r"rotations: must be \(frames, 3, 3\)"),
        ({"rotations": np.tile(2 * np.eye(3), (4, 1, 1))}, "frame 0 is not orthonormal"),
        ({"translations": np.zeros((3, 3))}, r"translations: must be \(4, 3\), got \(3, 3\)"),
        ({"translations": np.full((4, 3), np.nan)}, "missing"),
        ({"scales": np.ones(3)}, r"scales: must be \(4\)"),
        ({"scales": np.array([1.0, 0.0, 1.0, 1.0])}, "must be positive, got 0.0 in frame 1"),
    ],
)
def test_bad_head_motion_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _motion(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"neutral": np.zeros((3, 3))}, r"neutral: must be \(2, 3\)"),
        ({"neutral": np.full((2, 3), np.nan)}, "neutral: missing"),
        ({"shapes": np.ones((2, 2, 3))}, r"shapes: must be \(3, 2, 3\), got \(2, 2, 3\)"),
        ({"shapes": np.full((3, 2, 3), np.inf)}, "shapes: infinite"),
        ({"names": ("smile", "smile", "blink")}, "shape names: named twice: smile"),
        ({"markers": ("a", "a")}, "markers: named twice: a"),
    ],
)
def test_a_bad_model_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _model(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"values": np.zeros((4, 3))}, r"weights: must be \(frames, 2\), got \(4, 3\)"),
        ({"values": np.full((4, 2), np.inf)}, r"weights: infinite at \(0, 0\)"),
        ({"names": ("smile", "smile")}, "named twice: smile"),
        ({"rate": -1.0}, "rate must be from 0.001 to 1e6 frames"),
    ],
)
def test_bad_weights_are_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        _weights(**changes)
