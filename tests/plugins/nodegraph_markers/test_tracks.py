"""Where each marker is expected, and how far tracks are from there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_markers.tracks import UNNAMED, Tracks

FRAMES = 20
SHAPE = np.random.default_rng(2).normal(0.0, 40.0, (15, 3))


@pytest.fixture
def moving() -> Tracks:
    """Give a rigid shape that turns and shifts, one track per place, in order."""
    angles = np.linspace(0, 2, FRAMES)[:, None] * [0.3, 1.0, -0.2]
    turns = Rotation.from_rotvec(angles).as_matrix()
    positions = SHAPE @ turns.transpose(0, 2, 1) + np.arange(FRAMES)[:, None, None] * 5.0
    return Tracks(positions, np.ones((FRAMES, 15), dtype=np.bool_), SHAPE, 10.0)


def test_a_rigid_shape_is_expected_where_it_is(moving: Tracks) -> None:
    expected_places = moving.expectation(np.arange(15))
    assert expected_places.poses.known.all()
    np.testing.assert_allclose(
        expected_places.places, np.broadcast_to(SHAPE, (FRAMES, 15, 3)), atol=1e-9
    )
    frame = np.arange(FRAMES)
    distances = moving.distances(expected_places, frame, np.full(FRAMES, 3))
    expected = np.linalg.norm(SHAPE[3] - SHAPE, axis=1)
    np.testing.assert_allclose(distances, np.tile(expected, (FRAMES, 1)), atol=1e-9)


def test_a_marker_is_expected_to_move_with_those_around_it_whatever_bears_its_name(
    moving: Tracks,
) -> None:
    apart = np.linalg.norm(SHAPE - SHAPE[0], axis=1)
    near = np.argsort(apart)[:4]
    positions = moving.positions.copy()
    expected_places = moving.expectation(np.arange(15))
    outward = expected_places.poses.rotations[10].T @ np.array([0.0, 0.0, 6.0])
    positions[10, near] += outward
    moved = replace(moving, positions=positions).expectation(np.arange(15))
    assert 0.5 < moved.places[10, 0, 2] - SHAPE[0, 2] < 7.0
    positions[10, 0] += 50.0
    again = replace(moving, positions=positions)
    with_wrong, without = (
        again.expectation(np.where(np.arange(15) == 0, name, np.arange(15)))
        for name in (0, UNNAMED)
    )
    np.testing.assert_allclose(with_wrong.places[10, 0], without.places[10, 0], atol=1.0)


def test_few_names_tell_no_pose(moving: Tracks) -> None:
    named = np.full(15, UNNAMED)
    named[:3] = 0, 1, 2
    assert not moving.poses(named).known.any()
    named[3] = 3
    assert moving.poses(named).known.all()


def test_tracks_by_place_are_the_longest_of_those_that_share_a_frame(moving: Tracks) -> None:
    present = moving.present.copy()
    present[:5, 0] = present[15:, 1] = present[:12, 2] = False
    positions = np.where(present[..., None], moving.positions, np.nan)
    tracks = replace(moving, positions=positions, present=present)
    named = np.full(15, UNNAMED)
    named[[0, 1, 2]] = 7, 7, 8
    marked = tracks.marked(named)
    assert np.array_equal(marked[:15, 7], positions[:15, 1])
    assert np.array_equal(marked[15:, 7], positions[15:, 0])
    assert np.array_equal(marked[:, 8], positions[:, 2], equal_nan=True)
    assert np.isnan(marked[:, 0]).all()
