"""Poses are found exactly, never mirrored, and not where nothing tells them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_markers.rigid import far_apart, fit, fit_robustly, spacing

RANDOM = np.random.default_rng(1)
SHAPE = RANDOM.normal(0.0, 40.0, (8, 3))
TURNS = Rotation.random(5, random_state=2).as_matrix()
SHIFTS = RANDOM.normal(0.0, 200.0, (5, 3))
MOVED = (SHAPE - SHIFTS[:, None]) @ TURNS  # R p + t = q


def test_exact_poses_are_found_from_the_points_that_are_there() -> None:
    points, weights = MOVED.copy(), np.ones((5, 8))
    points[1, 2:5], weights[1, 2:5] = np.nan, 0.0
    poses = fit(points, SHAPE, weights)
    np.testing.assert_allclose(poses.rotations, TURNS, atol=1e-12)
    np.testing.assert_allclose(poses.translations, SHIFTS, atol=1e-10)
    np.testing.assert_allclose(poses.apply(MOVED), np.broadcast_to(SHAPE, (5, 8, 3)), atol=1e-10)


def test_too_few_points_or_a_line_tell_no_pose() -> None:
    line = np.linspace([0.0, 0, 0], [10.0, 20, 30], 8)
    weights = np.ones((2, 8))
    weights[1, 2:] = 0.0
    assert not fit(np.stack([line, line]), line, np.ones((2, 8))).known.any()
    poses = fit(MOVED[:2], SHAPE, weights)
    assert poses.known.tolist() == [True, False]
    assert np.array_equal(poses.rotations[1], np.eye(3))
    assert not poses.translations[1].any()
    assert not fit(MOVED, SHAPE, np.ones((5, 8)), fewest=9).known.any()


def test_points_that_went_astray_hardly_matter() -> None:
    shape = RANDOM.normal(0.0, 40.0, (30, 3))
    points = (shape - SHIFTS[:, None]) @ TURNS
    points[:, :5] += 30.0
    used = np.ones((5, 30), dtype=np.bool_)
    plain = fit(points, shape, used.astype(float)).apply(points)[:, 5:] - shape[5:]
    robust = fit_robustly(points, shape, used, width=10.0).apply(points)[:, 5:] - shape[5:]
    assert np.abs(plain).max() > 3.0
    assert np.abs(robust).max() < 0.1


def test_spacing_is_the_median_distance_to_the_nearest() -> None:
    shape = np.array([[0.0, 0, 0], [3, 0, 0], [10, 0, 0], [10, 0, 0], [np.nan] * 3, [30, 0, 0]])
    assert spacing(shape) == pytest.approx(np.median([3, 3, 7, 20]))
    assert spacing(shape[2:4]) == np.inf


def test_each_point_far_apart_is_the_farthest_from_those_before() -> None:
    points = np.random.default_rng(0).normal(0.0, 40.0, (50, 3))
    numbers = far_apart(points, 6)
    assert len(set(numbers)) == 6
    assert numbers[0] == np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1))
    for count in range(1, 6):
        apart = np.linalg.norm(points[:, None] - points[numbers[:count]], axis=2).min(axis=1)
        assert numbers[count] == np.argmax(apart)
