"""The compiled loops do what their docstrings say, beside NumPy's decomposition."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from nodegraph_align.rigid_kernel import (
    AS_IT_IS,
    FEW,
    FITTED,
    LEAST_SQUARES,
    LINE,
    MIRRORED,
    RMS,
    fit,
    move_into,
)
from tests.plugins.nodegraph_align.heads import plain_fit, random_rotations

Array = NDArray[np.float64]
FLAT = {"solid": 1.0, "thin": 0.05, "nearly flat": 1e-9, "flat": 0.0}


def fitted(positions: Array, shape: Array, **changes: object) -> Any:
    message: dict[str, Any] = {"weights": np.ones((1, len(shape))), "scaling": AS_IT_IS}
    message |= {"reflection": False, "columns": np.arange(len(shape))} | changes
    return fit(
        positions,
        message["columns"],
        shape,
        message["weights"],
        message["scaling"],
        message["reflection"],
    )


@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(3, 12),
    depth=st.sampled_from([1.0, 0.3, 0.02, 1e-4, 1e-8, 0.0]),
    noise=st.sampled_from([0.0, 1e-9, 0.1, 5.0]),
    mirror=st.booleans(),
    reflection=st.booleans(),
    far=st.sampled_from([0.0, 1.0, 1500.0]),
)
def test_pose_is_that_of_the_singular_value_decomposition(
    seed: int, count: int, depth: float, noise: float, mirror: bool, reflection: bool, far: float
) -> None:
    random = np.random.default_rng(seed)
    shape = random.normal(0, 50, (count, 3)) * [1.0, 0.7, depth]
    turn = random_rotations(1, seed)[0]
    points = shape * [1.0, 1.0, -1.0 if mirror else 1.0] @ turn.T
    points = points + random.normal(0, 1, points.shape) * noise + far * random.normal(0, 1, 3)
    weights = random.uniform(0.1, 2.0, count)
    expected, centre, goal = plain_fit(points, shape, weights, reflection=reflection)
    covariance = (shape - goal).T @ (weights[:, None] * (points - centre))
    sizes = np.linalg.svd(covariance, compute_uv=False)
    mirrored = np.linalg.det(covariance) < 0 and not reflection
    # how well the data tell the turn: nothing can be told where this is small
    gap = (sizes[1] + (-sizes[2] if mirrored else sizes[2])) / sizes[0]
    if sizes[1] < 2e-3 * sizes[0] or gap < 1e-3:
        return
    output, scales, centres, goals, states = fitted(
        points[None], shape, weights=weights[None], reflection=reflection
    )
    assert states[0] in (FITTED, MIRRORED)
    assert scales[0] == 1.0
    np.testing.assert_allclose(output[0] @ output[0].T, np.eye(3), rtol=0, atol=1e-14)
    np.testing.assert_allclose(centres[0], centre, rtol=1e-13, atol=1e-11)
    np.testing.assert_allclose(goals[0], goal, rtol=1e-13, atol=1e-11)
    # of a plane the decomposition gives either image
    if not reflection or sizes[2] > 1e-9 * sizes[0]:
        np.testing.assert_allclose(output[0], expected, rtol=0, atol=1e-12 * (1 + far / 50) / gap)
    assert np.linalg.det(output[0]) > 0 or reflection


@pytest.mark.parametrize("depth", FLAT.values(), ids=FLAT)
@pytest.mark.parametrize("axis", [0, 1, 2, (1, 1, 1), (1, 2, 0)])
def test_half_turns_and_no_turn_are_found(depth: float, axis: object) -> None:
    direction = np.eye(3)[axis] if isinstance(axis, int) else np.array(axis, dtype=np.float64)
    direction /= np.linalg.norm(direction)
    half = 2.0 * np.outer(direction, direction) - np.eye(3)
    shape = np.random.default_rng(3).normal(0, 50, (7, 3)) * [1.0, 0.7, depth]
    positions = np.stack([shape, shape @ half.T])
    rotations, _, _, _, states = fitted(positions, shape)
    np.testing.assert_allclose(rotations, [np.eye(3), half.T], rtol=0, atol=1e-13)
    assert states.tolist() == [FITTED, FITTED]


def test_three_noisy_landmarks_never_give_a_mirror_image() -> None:
    random = np.random.default_rng(1)
    shape = random.normal(0, 50, (3, 3))
    positions = shape @ random_rotations(300) + random.normal(0, 2, (300, 3, 3))
    for reflection in (False, True):  # they fit turned over as well, so that none is needed
        output, *_ = fitted(positions, shape, reflection=reflection)
        assert np.linalg.det(output).min() > 0.999


def test_mirror_images_are_called_so_and_fitted_where_allowed() -> None:
    shape = np.random.default_rng(2).normal(0, 50, (8, 3))
    positions = (shape * [-1.0, 1.0, 1.0])[None]
    rotations, *_, states = fitted(positions, shape)
    assert np.linalg.det(rotations[0]) == pytest.approx(1.0)
    assert states[0] == MIRRORED
    rotations, *_, states = fitted(positions, shape, reflection=True)
    np.testing.assert_allclose(rotations[0], np.diag([-1.0, 1.0, 1.0]), rtol=0, atol=1e-14)
    assert states[0] == FITTED


def test_flat_and_noisy_landmarks_are_not_called_mirror_images() -> None:
    random = np.random.default_rng(4)
    shape = random.normal(0, 50, (6, 3)) * [1.0, 1.0, 0.01]
    positions = shape @ random_rotations(500) + random.normal(0, 1, (500, 6, 3))
    assert np.all(fitted(positions, shape)[4] == FITTED)


@pytest.mark.parametrize("scaling", [AS_IT_IS, RMS, LEAST_SQUARES])
def test_scale_is_the_ratio_of_sizes_or_what_fits_best(scaling: int) -> None:
    random = np.random.default_rng(5)
    shape = random.normal(0, 50, (9, 3))
    points = 0.4 * shape + random.normal(0, 5, shape.shape)
    rotations, scales, *_ = fitted(points[None], shape, scaling=scaling)
    x, y = points - points.mean(axis=0), shape - shape.mean(axis=0)
    turned = x @ rotations[0].T
    plain = {
        AS_IT_IS: 1.0,
        RMS: np.sqrt((y**2).sum() / (x**2).sum()),
        LEAST_SQUARES: np.linalg.lstsq(turned.reshape(-1, 1), y.ravel(), rcond=None)[0][0],
    }
    assert scales[0] == pytest.approx(plain[scaling], rel=1e-12)


def test_columns_choose_the_landmarks_and_missing_ones_do_not_count() -> None:
    random = np.random.default_rng(6)
    columns = np.array([7, 0, 3, 9, 4])
    shape, positions = random.normal(0, 50, (5, 3)), random.normal(0, 50, (4, 10, 3))
    positions[1, 3] = positions[2, [7, 9]] = positions[3, [7, 9, 4]] = np.nan
    rotations, _, centres, goals, states = fitted(positions, shape, columns=columns)
    for frame in range(3):
        there = ~np.isnan(positions[frame, columns, 0])
        expected = plain_fit(positions[frame, columns][there], shape[there])
        for output, plain in zip((rotations, centres, goals), expected, strict=True):
            np.testing.assert_allclose(output[frame], plain, rtol=0, atol=1e-12)
    assert states[3] == FEW
    np.testing.assert_array_equal(rotations[3], np.eye(3))
    assert not centres[3].any()
    assert not goals[3].any()


@pytest.mark.parametrize("far", [0.0, 3000.0])
def test_lines_and_single_places_tell_no_turn(far: float) -> None:
    random = np.random.default_rng(8)
    shape = random.normal(0, 50, (5, 3))
    line = np.outer(np.arange(5.0), [3.0, -2.0, 5.0])
    place = np.tile(random.normal(0, 50, 3) / 3.0, (5, 1))
    nearly = line + random.normal(0, 1e-3, line.shape)
    positions = np.stack([line, place, nearly]) + far / 7.0
    rotations, *_, states = fitted(positions, shape)
    assert states.tolist() == [LINE, LINE, LINE]
    np.testing.assert_array_equal(rotations, np.tile(np.eye(3), (3, 1, 1)))
    assert fitted(shape[None] + far, place)[4].tolist() == [LINE]


def test_every_point_is_moved_and_the_identity_changes_no_bit() -> None:
    random = np.random.default_rng(10)
    positions = random.normal(0, 50, (3, 4, 3))
    positions[1, 2] = np.nan
    matrices, offsets = random.normal(0, 1, (3, 3, 3)), random.normal(0, 50, (3, 3))
    matrices[2], offsets[2] = np.eye(3), 0.0
    rotations = np.empty_like(positions)
    move_into(rotations, positions, matrices, offsets)
    expected = np.einsum("tij,tmj->tmi", matrices, positions) + offsets[:, None]
    np.testing.assert_allclose(rotations, expected, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(rotations[2], positions[2])
