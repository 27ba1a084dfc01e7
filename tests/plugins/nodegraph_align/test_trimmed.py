"""The landmarks that fit best are found, however far off the others are."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_align.procrustes import procrustes
from nodegraph_align.trimmed import trimmed
from nodegraph_mocap import HeadMotion, Trajectories
from tests.plugins.nodegraph_align.heads import make_head, make_recording, plain_fit, run_moved

Array = NDArray[np.float64]
Shaken = tuple[Trajectories, Trajectories, HeadMotion]


@pytest.fixture(scope="module")
def shaken() -> Shaken:
    """A face at rest; moved, with noise, and three landmarks of ten shifted together."""
    rest, motion = make_head(frames=30, seed=2)
    take, random = run_moved(rest, motion), np.random.default_rng(3)
    positions = take.positions + random.normal(0, 0.2, take.positions.shape)
    for frame in positions:
        frame[random.choice(10, 3, replace=False)] += random.normal(0, 15, 3)
    return rest, replace(take, positions=positions), motion


NAMES = tuple(f"m{index}" for index in range(10))


def sums(placed: Array, shape: Array, count: int) -> Array:
    squared = np.sort(((placed - shape) ** 2).sum(axis=2), axis=1)
    return np.asarray(squared[:, :count].sum(axis=1))


def test_the_sum_is_the_smallest_of_all_choices(shaken: Shaken) -> None:
    rest, take, _ = shaken
    points, shape = take.positions[:8, :10], rest.positions[0, :10]
    least = np.full(8, np.inf)
    for choice in combinations(range(10), 7):
        some = list(choice)
        for frame in range(8):
            turn, centre, goal = plain_fit(points[frame, some], shape[some])
            apart = (points[frame, some] - centre) @ turn.T + goal - shape[some]
            least[frame] = min(least[frame], (apart**2).sum())
    aligned = trimmed(take, rest, landmarks=NAMES, share=0.7).aligned.positions[:8, :10]
    np.testing.assert_allclose(sums(aligned, shape, 7), least, rtol=1e-9)


def test_landmarks_far_off_do_nothing(shaken: Shaken) -> None:
    rest, take, motion = shaken
    aligned = trimmed(take, rest, landmarks=NAMES, share=0.7).head_motion.rotations
    plain = procrustes(take, rest, landmarks=NAMES).head_motion.rotations
    error, other = (
        np.abs(rotations - motion.rotations).max(axis=(1, 2)) for rotations in (aligned, plain)
    )
    assert error.max() < 0.02
    assert error.mean() < 0.1 * other.mean()


def test_all_of_them_is_procrustes(shaken: Shaken) -> None:
    rest, take, _ = shaken
    aligned = trimmed(take, rest, share=1.0).aligned.positions
    np.testing.assert_array_equal(aligned, procrustes(take, rest).aligned.positions)


@pytest.mark.parametrize(("share", "count"), [(0.01, 3), (0.45, 5), (0.5, 5), (0.7, 7)])
def test_share_is_rounded_up_and_three_at_least(shaken: Shaken, share: float, count: int) -> None:
    rest, take, _ = shaken
    aligned = trimmed(take, rest, landmarks=NAMES, share=share).aligned.positions[:, :10]
    shape = rest.positions[0, :10]
    best = sums(aligned, shape, count)
    for other in {3, 5, 7} - {count}:
        again = trimmed(take, rest, landmarks=NAMES, share=other / 10).aligned.positions[:, :10]
        assert best.sum() < sums(again, shape, count).sum()


def test_missing_landmarks_make_the_choice_smaller(shaken: Shaken) -> None:
    rest, take, motion = shaken
    positions = take.positions.copy()
    positions[0, :2] = positions[1, :8] = np.nan
    gappy = make_recording(positions)
    with pytest.warns(UserWarning, match="1 of 30 frames .first 1. left as they are, with fewer"):
        aligned = trimmed(gappy, rest, landmarks=NAMES, share=0.6)
    np.testing.assert_array_equal(aligned.aligned.positions[1], positions[1])
    assert np.abs(aligned.head_motion.rotations[0] - motion.rotations[0]).max() < 0.02


def test_the_nearest_on_a_line_leave_the_pose_before() -> None:
    line = np.outer(np.arange(4.0), [30.0, 0.0, 0.0])
    shape = np.vstack([line, [[40.0, 50.0, 0.0], [20.0, -40.0, 30.0]]])
    off = shape.copy()
    off[4] += [0.0, 0.0, 9.0]
    off[5] += [0.0, 9.0, 0.0]
    aligned = trimmed(make_recording([off]), make_recording([shape]), share=0.6)
    assert aligned.aligned.present.all()
    assert np.abs(aligned.aligned.positions[0] - shape).max() < 15.0
    assert np.abs(aligned.head_motion.rotations[0] - np.eye(3)).max() < 0.3


def test_a_quarter_of_sixty_that_moves_together_does_nothing() -> None:
    rest, motion = make_head(frames=4, markers=60, seed=5)
    take, names = run_moved(rest, motion), tuple(f"m{index}" for index in range(60))
    positions = take.positions.copy()
    positions[:, ::4] += 60.0  # every fourth, all alike
    aligned = trimmed(replace(take, positions=positions), rest, landmarks=names, share=0.7)
    np.testing.assert_allclose(aligned.head_motion.rotations, motion.rotations, atol=1e-10)


@pytest.mark.parametrize("share", [0.0, 1.5, float("nan")])
def test_shares_that_are_none(shaken: Shaken, share: float) -> None:
    with pytest.raises(ValueError, match="share must be above 0 and at most 1"):
        trimmed(shaken[1], shaken[0], share=share)
