from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_synthesize.movement import (
    rotations_of,
    skin_movement,
)


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
