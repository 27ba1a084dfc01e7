"""Huber's loss is least at the pose that is found, and a single landmark does little."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_align import huber as module
from nodegraph_align.huber import huber
from nodegraph_align.procrustes import procrustes
from nodegraph_mocap import HeadMotion, Trajectories
from tests.plugins.nodegraph_align.heads import (
    make_head,
    make_recording,
    random_rotations,
    run_moved,
)

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def shaken() -> tuple[Trajectories, Trajectories, HeadMotion]:
    """A face at rest; moved, with noise, and one landmark of six far off; and its motion."""
    rest, motion = make_head(frames=25, seed=1)
    take, random = run_moved(rest, motion), np.random.default_rng(1)
    positions = take.positions + random.normal(0, 0.2, take.positions.shape)
    positions[np.arange(25), random.integers(0, 6, 25)] += random.normal(0, 20, (25, 3))
    return rest, replace(take, positions=positions), motion


def loss(placed: Array, shape: Array, width: float) -> Array:
    apart = np.linalg.norm(placed - shape, axis=2)
    each = np.where(apart <= width, apart**2 / 2, width * (apart - width / 2))
    return np.asarray(each.sum(axis=1))


@pytest.mark.parametrize("width", [0.1, 1.0, 8.0])
def test_no_pose_near_it_has_a_smaller_loss(
    shaken: tuple[Trajectories, Trajectories, HeadMotion], width: float
) -> None:
    rest, take, _ = shaken
    actual, shape = huber(take, rest, width=width).aligned.positions[:, :6], rest.positions[0, :6]
    least, middle = loss(actual, shape, width), shape.mean(axis=0)
    random = np.random.default_rng(2)
    for size in (1e-1, 1e-3):
        for turn in random_rotations(20, 3):
            small = np.linalg.qr(np.eye(3) + size * (turn - turn.T))[0]
            small = small * np.sign(np.diag(small))
            nudged = (actual - middle) @ small + middle + size * random.normal(0, 1, 3)
            assert np.all(loss(nudged, shape, width) > least)


def test_a_landmark_far_off_does_little(
    shaken: tuple[Trajectories, Trajectories, HeadMotion],
) -> None:
    rest, take, motion = shaken

    def error(rotations: Array) -> float:
        return float(np.abs(rotations - motion.rotations).max())

    robust = error(huber(take, rest).head_motion.rotations)
    assert robust < 0.1 * error(procrustes(take, rest).head_motion.rotations)
    assert robust < 0.05


def test_a_wide_one_is_procrustes(shaken: tuple[Trajectories, Trajectories, HeadMotion]) -> None:
    rest, take, _ = shaken
    for first, second in zip(huber(take, rest, width=1e6), procrustes(take, rest), strict=True):
        for field in ("positions", "rotations", "translations"):
            if hasattr(first, field):
                np.testing.assert_array_equal(getattr(first, field), getattr(second, field))


def test_scales_are_found_in_spite_of_one_far_off(
    shaken: tuple[Trajectories, Trajectories, HeadMotion],
) -> None:
    rest, take, _ = shaken
    smaller = replace(take, positions=0.5 * take.positions)
    scales = huber(smaller, rest, scale="least_squares").head_motion.scales
    np.testing.assert_allclose(scales, 0.5, atol=0.01)
    plain = procrustes(smaller, rest, scale="least_squares").head_motion.scales
    assert np.abs(plain - 0.5).mean() > 3 * np.abs(scales - 0.5).mean()


def test_missing_landmarks_and_frames_without(
    shaken: tuple[Trajectories, Trajectories, HeadMotion],
) -> None:
    rest, take, _ = shaken
    positions = take.positions.copy()
    positions[3, 0] = positions[4, :4] = np.nan
    gappy = make_recording(positions)
    with pytest.warns(UserWarning, match=r"1 of 25 frames [(]first 4[)] left as they are"):
        aligned = huber(gappy, rest)
    np.testing.assert_array_equal(aligned.aligned.positions[4], positions[4])
    others = np.arange(25) >= 5
    expected = huber(take, rest).aligned.positions
    np.testing.assert_array_equal(aligned.aligned.positions[others], expected[others])


def test_frames_that_do_not_come_to_rest_are_counted(
    shaken: tuple[Trajectories, Trajectories, HeadMotion], monkeypatch: pytest.MonkeyPatch
) -> None:
    rest, take, _ = shaken
    monkeypatch.setattr(module, "_ROUNDS", 1)
    with pytest.warns(UserWarning, match="25 of 25 frames have not come to rest"):
        huber(take, rest)


@pytest.mark.parametrize("width", [0.0, -1.0, float("nan")])
def test_widths_that_are_none(
    shaken: tuple[Trajectories, Trajectories, HeadMotion], width: float
) -> None:
    with pytest.raises(ValueError, match="width must be positive"):
        huber(shaken[1], shaken[0], width=width)
