"""Landmarks, placed by poses, and how far they are then from where they belong."""

from __future__ import annotations

import numpy as np

from nodegraph_align.fitting import Fitting
from nodegraph_align.reference import reference_of
from tests.plugins.nodegraph_align.heads import make_head, run_moved


def test_landmarks_in_the_references_order() -> None:
    rest, motion = make_head(frames=3)
    take, names = run_moved(rest, motion), ["m5", "m11", "m0", "m2"]
    fitting = Fitting.of(take, reference_of(take, rest, names)[0], "rms")
    np.testing.assert_array_equal(fitting.points, take.positions[:, [5, 11, 0, 2]])
    np.testing.assert_array_equal(fitting.shape, rest.positions[0, [5, 11, 0, 2]])
    assert fitting.scale == "rms"


def test_distances_are_those_of_the_placed_landmarks() -> None:
    rest, motion = make_head(frames=4)
    points = run_moved(rest, motion).positions + np.random.default_rng(0).normal(0, 3, (4, 12, 3))
    points[2, 7] = np.nan
    fitting = Fitting(points, rest.positions[0], "rms")
    poses = fitting.fit()
    apart = fitting.distances(poses)
    for frame in range(4):
        x = points[frame] - poses.centres[frame]
        placed = poses.scales[frame] * x @ poses.rotations[frame].T + poses.goals[frame]
        plain = np.linalg.norm(placed - fitting.shape, axis=1)
        np.testing.assert_allclose(apart[frame], np.where(np.isnan(plain), np.inf, plain))
    assert np.isinf(apart).sum() == 1


def test_some_frames_fit_as_they_do_among_all() -> None:
    rest, motion = make_head(frames=6)
    points = run_moved(rest, motion).positions + np.random.default_rng(0).normal(0, 3, (6, 12, 3))
    fitting, weights = Fitting(points, rest.positions[0], "none"), np.ones((6, 12))
    weights[:, 3:6] = 0.1
    which = np.array([5, 2])
    whole, some = fitting.fit(weights), fitting.some(which).fit(weights[which])
    np.testing.assert_array_equal(some.rotations, whole.rotations[which])
    assert np.abs(whole.rotations - fitting.fit().rotations).max() > 1e-4
