from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_synthesize.movement import (
    head_motion,
    rotations_of,
    skin_movement,
)


@pytest.mark.parametrize("seed", range(3))
def test_the_head_moves_within_bounds_from_rest(seed: int) -> None:
    motion = head_motion(np.random.default_rng(seed), 1800, 60.0, 190.0)
    angles = np.degrees(Rotation.from_matrix(motion.rotations).magnitude())
    shifts = np.linalg.norm(motion.translations, axis=1)
    assert 1.0 < angles.max() < 5.0
    assert 1.0 < shifts.max() < 190.0 / 20
    # For 0.3 s the head rests.
    np.testing.assert_array_equal(motion.rotations[:19], np.tile(np.eye(3), (19, 1, 1)))
    np.testing.assert_array_equal(motion.translations[:19], 0.0)
    assert motion.translations[20:].any(axis=1).all()
    assert np.abs(np.diff(motion.translations, axis=0)).max() < 0.5
    np.testing.assert_array_equal(motion.scales, 1.0)


def test_rotations_are_rodrigues() -> None:
    vectors = np.random.default_rng(0).standard_normal((20, 3))
    vectors[0] = 0.0
    expected = Rotation.from_rotvec(vectors).as_matrix()
    np.testing.assert_allclose(rotations_of(vectors), expected, rtol=0, atol=1e-12)


def test_the_skin_moves_little_and_neighbours_alike() -> None:
    points = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [90.0, 50.0, 0.0]])
    movement = skin_movement(np.random.default_rng(0), points, 20000, 60.0)
    assert np.sqrt(np.mean(movement**2)) == pytest.approx(0.2, rel=0.25)
    np.testing.assert_array_equal(movement[:19], 0.0)
    first, near, far = movement[..., 1].T
    assert np.corrcoef(first, near)[0, 1] > 0.9
    assert abs(np.corrcoef(first, far)[0, 1]) < 0.6
