"""Poses in six numbers, what is left of them, and how far they are apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_mocap import HeadMotion
from nodegraph_score.pose import check_proper, degrees_apart, left_over, pose


def motion(vectors: NDArray[np.float64], *, scale: float = 1.0, seed: int = 0) -> HeadMotion:
    """Return turns by rotation vectors in degrees, with any translations."""
    shifts = np.random.default_rng(seed).normal(0.0, 5.0, (len(vectors), 3))
    return HeadMotion(
        rotations=Rotation.from_rotvec(vectors, degrees=True).as_matrix(),
        translations=shifts,
        scales=np.full(len(vectors), scale),
    )


def some(frames: int = 20, *, seed: int = 0, scale: float = 1.0) -> HeadMotion:
    vectors = np.random.default_rng(seed).normal(0.0, 20.0, (frames, 3))
    return motion(vectors, seed=seed + 1, scale=scale)


def placed(points: NDArray[np.float64], where: HeadMotion) -> NDArray[np.float64]:
    """Return ``s R x + t``, frame by frame and point by point."""
    return np.array(
        [
            [s * (r @ point) + t for point in frame]
            for frame, r, t, s in zip(
                points, where.rotations, where.translations, where.scales, strict=True
            )
        ]
    )


def test_a_turn_to_and_fro_about_one_axis_is_its_angle() -> None:
    angles = np.array([-8.0, -1.0, 0.0, 3.0, 6.0])
    numbers = pose(motion(angles[:, None] * [0.0, 1.0, 0.0]))
    np.testing.assert_allclose(numbers[:, 1], angles - angles.mean(), atol=0.01)
    np.testing.assert_allclose(numbers[:, [0, 2]], 0.0, atol=1e-9)
    np.testing.assert_array_equal(
        numbers[:, 3:], motion(angles[:, None] * [0.0, 1.0, 0.0]).translations
    )


def test_a_head_that_is_seen_from_behind_does_not_jump() -> None:
    """Its rotations are about half a turn, where a rotation vector changes its sign."""
    wobble = np.linspace(-5.0, 5.0, 21)
    behind = motion((180.0 + wobble)[:, None] * [0.0, 1.0, 0.0])
    steps = np.diff(pose(behind)[:, :3], axis=0)
    np.testing.assert_allclose(steps, np.tile([0.0, 0.5, 0.0], (20, 1)), atol=1e-6)


@given(angle=st.floats(0.0, 180.0), seed=st.integers(0, 99))
def test_two_rotations_are_apart_by_the_angle_between_them(angle: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis), degrees=True).as_matrix()
    first = some(1, seed=seed)
    second = HeadMotion(
        rotations=turn @ first.rotations, translations=first.translations, scales=first.scales
    )
    assert degrees_apart(first, second)[0] == pytest.approx(angle, abs=1e-6)
    assert degrees_apart(second, first)[0] == pytest.approx(angle, abs=1e-6)


def test_what_is_left_over_leads_from_the_aligned_face_to_what_was_made() -> None:
    true, actual = some(seed=1, scale=1.2), some(seed=5, scale=0.8)
    aligned = np.random.default_rng(0).normal(0.0, 40.0, (20, 6, 3))
    captured = placed(aligned, true)
    estimate = np.array(
        [
            [r.T @ (point - t) / s for point in frame]
            for frame, r, t, s in zip(
                captured, actual.rotations, actual.translations, actual.scales, strict=True
            )
        ]
    )
    np.testing.assert_allclose(placed(aligned, left_over(true, actual)), estimate, atol=1e-9)
    nothing = left_over(true, true)
    np.testing.assert_allclose(nothing.rotations, np.tile(np.eye(3), (20, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(nothing.translations, 0.0, atol=1e-12)


def test_a_mirror_image_is_refused_by_its_frame() -> None:
    rotations = np.tile(np.eye(3), (5, 1, 1))
    rotations[3] = np.diag([-1.0, 1.0, 1.0])
    mirrored = HeadMotion(rotations=rotations, translations=np.zeros((5, 3)), scales=np.ones(5))
    with pytest.raises(ValueError, match=r"truth, frame 3: .* mirror image \(1 of 5 frames\)"):
        check_proper("truth", mirrored)
    with pytest.raises(ValueError, match="mirror image"):
        pose(mirrored)
