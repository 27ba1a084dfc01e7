"""Frames are brought onto their own mean shape."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_align import generalized as module
from nodegraph_align.generalized import generalized
from nodegraph_align.poses import Scale
from nodegraph_align.procrustes import procrustes
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_align.heads import make_head, make_recording, run_moved
from tests.plugins.recordings import quietly

Array = NDArray[np.float64]
SCALES = get_args(Scale)


@pytest.fixture(scope="module")
def scans() -> Trajectories:
    """Faces of somewhat different shape and size anywhere, the third of them the fullest."""
    rest, motion = make_head(frames=30, seed=4)
    random = np.random.default_rng(4)
    take = run_moved(rest, replace(motion, scales=random.uniform(0.9, 1.1, 30)))
    positions = take.positions + random.normal(0, 3, take.positions.shape)
    positions[random.random((30, 12)) < 0.1] = np.nan
    positions[:2, 0] = np.nan
    positions[2, :6] = take.positions[2, :6]
    return make_recording(positions)


def spread(aligned: Any) -> float:
    """Sum of squared distances from the mean shape of the landmarks."""
    return float(np.nansum((aligned.aligned.positions - aligned.reference.positions)[:, :6] ** 2))


@pytest.mark.parametrize("scale", SCALES)
def test_the_reference_is_the_mean_and_frames_are_aligned_to_it(
    scans: Trajectories, scale: Scale
) -> None:
    aligned = quietly(generalized, scans, scale=scale)
    again = quietly(procrustes, scans, aligned.reference, scale=scale)
    np.testing.assert_allclose(again.aligned.positions, aligned.aligned.positions, atol=1e-7)
    mean = np.nanmean(aligned.aligned.positions, axis=0)
    middle, goal = mean[:6].mean(axis=0), aligned.reference.positions[0, :6].mean(axis=0)
    shape = aligned.reference.positions[0]
    if scale == "none":
        np.testing.assert_allclose(mean, shape, atol=1e-7)
    else:  # a mean of shapes is smaller than they are
        ratio = np.linalg.norm(shape[:6] - goal) / np.linalg.norm(mean[:6] - middle)
        assert 1.0 < ratio < 1.01
        np.testing.assert_allclose((mean - middle) * ratio + goal, shape, atol=1e-7)


@pytest.mark.parametrize("scale", SCALES)
def test_the_fullest_frame_stays(scans: Trajectories, scale: Scale) -> None:
    aligned = quietly(generalized, scans, scale=scale)
    np.testing.assert_allclose(aligned.aligned.positions[2], scans.positions[2], atol=1e-7)


def test_the_sum_is_no_larger_than_for_any_reference(scans: Trajectories) -> None:
    least = spread(quietly(generalized, scans))
    random = np.random.default_rng(5)
    best = quietly(generalized, scans).reference
    for size in (0.01, 0.3, 3.0):
        nudged = replace(best, positions=best.positions + random.normal(0, size, (1, 12, 3)))
        aligned = quietly(procrustes, scans, nudged)
        mean = np.nanmean(aligned.aligned.positions, axis=0, keepdims=True)
        assert spread(aligned._replace(reference=replace(best, positions=mean))) > least


def test_rigid_scans_give_back_one_shape() -> None:
    rest, motion = make_head(frames=9)
    cases: tuple[tuple[Array, Scale], ...]
    cases = ((np.ones(9), "none"), (np.linspace(1.0, 2.0, 9), "rms"))
    for scales, how in cases:
        take = run_moved(rest, replace(motion, scales=scales))
        aligned = generalized(take, scale=how)
        home = np.repeat(take.positions[:1], 9, axis=0)
        np.testing.assert_allclose(aligned.aligned.positions, home, atol=1e-8)
        np.testing.assert_allclose(aligned.head_motion.scales, scales, atol=1e-10)


def test_no_frame_needs_all_landmarks() -> None:
    rest, motion = make_head(frames=12)
    positions = run_moved(rest, motion).positions.copy()
    positions[np.arange(12), np.arange(12) % 6] = np.nan
    take = make_recording(positions)
    aligned = quietly(generalized, take)
    shape = aligned.reference.positions[0]
    assert not np.isnan(shape).any()
    expected = np.where(np.isnan(positions), np.nan, shape)
    np.testing.assert_allclose(aligned.aligned.positions, expected, atol=1e-6)
    own = procrustes(aligned.reference, rest).aligned.positions
    np.testing.assert_allclose(own, rest.positions, atol=1e-6)


def test_frames_that_cannot_be_fitted_are_no_part_of_the_mean(scans: Trajectories) -> None:
    positions = np.concatenate([scans.positions, scans.positions[-1:] + 500.0])
    positions[-1, 1:6] = np.nan
    aligned = quietly(generalized, make_recording(positions))
    expected = quietly(generalized, scans)
    np.testing.assert_array_equal(aligned.reference.positions, expected.reference.positions)
    np.testing.assert_array_equal(aligned.aligned.positions[-1], positions[-1])


def test_landmarks_and_markers_never_seen() -> None:
    rest, motion = make_head(frames=5)
    positions = run_moved(rest, motion).positions.copy()
    positions[:, [1, 9]] = np.nan
    take = make_recording(positions)
    with pytest.warns(UserWarning, match="1 landmarks are missing in every frame"):
        aligned = generalized(take)
    assert np.flatnonzero(~aligned.reference.present[0]).tolist() == [1, 9]
    assert aligned.reference.markers == take.markers


def test_a_shape_that_is_still_moving_is_reported(
    scans: Trajectories, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_ROUNDS", 1)
    with pytest.warns(UserWarning, match="after 1 rounds the mean shape still moves by .*e-0"):
        generalized(scans)


def test_what_has_no_mean_shape() -> None:
    for bad, text in (
        (np.empty((0, 6, 3)), "there is none"),
        (np.full((3, 6, 3), np.nan), "needs 3 landmarks"),
        (np.full((3, 6, 3), 5.0), "all in one place"),
        (np.tile(np.outer(np.arange(6.0), [1.0, 2.0, 3.0]), (3, 1, 1)), "lie on a line"),
    ):
        with pytest.raises(Refusal, match=text):
            generalized(make_recording(bad))
    with pytest.raises(ValueError, match="give `landmarks`"):
        generalized(make_recording(np.ones((3, 6, 3)), stable=None))
