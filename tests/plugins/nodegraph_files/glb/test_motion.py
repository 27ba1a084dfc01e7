from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_files.glb.writing import held_weights, quaternions
from nodegraph_mocap import Animation, Weights
from nodegraph_mocap.specimens import heads

HEAD = heads()["complete"]
NAN = np.nan


def animation(values: object) -> Animation:
    array = np.asarray(values, dtype=np.float64)
    weights = Weights(values=array, names=HEAD.names[: array.shape[1]], rate=60.0)
    return Animation(head=HEAD, weights=weights)


def plainly_held(column: NDArray[np.float64]) -> list[float]:
    known = [value for value in column if not np.isnan(value)]
    last = known[0] if known else 0.0
    held = []
    for value in column:
        last = last if np.isnan(value) else value
        held.append(last)
    return held


def test_a_missing_weight_repeats_the_last_known() -> None:
    values = np.array([[NAN, 1, 2], [3, NAN, 4], [NAN, NAN, 5], [6, 7, 8], [NAN, 9, NAN]])
    with pytest.warns(
        UserWarning, match="6 weights in 4 frames are missing, and repeat .*; the ea"
    ):
        held = held_weights(animation(values))
    np.testing.assert_array_equal(held.T, [plainly_held(column) for column in values.T])
    assert held[:, 0].tolist() == [3, 3, 3, 6, 6]


def test_a_weight_that_is_never_known_stays_zero_and_is_named() -> None:
    message = "'mouthSmileLeft' in frame 0; mouthSmileLeft have none at all and stay 0"
    with pytest.warns(UserWarning, match=message):
        held = held_weights(animation([[0.5, NAN], [0.25, NAN]]))
    assert held.tolist() == [[0.5, 0, 0], [0.25, 0, 0]]


def test_complete_weights_stay_as_they_are() -> None:
    values = np.random.default_rng(0).normal(size=(5, 3))
    np.testing.assert_array_equal(held_weights(animation(values)), values)


@pytest.mark.parametrize("seed", range(5))
def test_quaternions_are_the_rotations_and_never_jump(seed: int) -> None:
    axis = np.random.default_rng(seed).normal(size=3)
    axis /= np.linalg.norm(axis)
    turns = Rotation.from_rotvec(np.linspace(0, 6 * np.pi, 200)[:, None] * axis)
    turns_read = quaternions(turns.as_matrix())
    np.testing.assert_allclose(np.linalg.norm(turns_read, axis=1), 1)
    assert np.einsum("ti,ti->t", turns_read[1:], turns_read[:-1]).min() > 0.99
    # the identity by Rodrigues' formula, without the library that made them
    vectors, real = turns_read[:, :3], turns_read[:, 3]
    point = np.array([0.3, -0.2, 0.9])
    moved = point + 2 * np.cross(vectors, np.cross(vectors, point) + real[:, None] * point)
    np.testing.assert_allclose(moved, turns.as_matrix() @ point, atol=1e-12)


def test_a_reflection_is_refused_with_its_frame() -> None:
    rotations = np.tile(np.eye(3), (4, 1, 1))
    rotations[2:] *= -1
    with pytest.raises(ValueError, match=r"head motion: frame 2 is a reflection \(2 such frames\)"):
        quaternions(rotations)
