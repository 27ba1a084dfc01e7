"""One pose of all markers, as far as a recording tells."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_mocap.reference_shape import reference_shape
from tests.plugins.recordings import make_recording


def test_it_is_the_most_complete_frame() -> None:
    positions = np.random.default_rng(0).normal(size=(4, 5, 3))
    positions[0, 1] = positions[3, 2] = np.nan
    np.testing.assert_array_equal(reference_shape(make_recording(positions)), positions[1])


def test_a_marker_missing_there_comes_from_a_turned_head() -> None:
    shape = np.random.default_rng(1).normal(size=(6, 3)) * 50
    turned = Rotation.from_rotvec([0.5, 1.0, -0.3]).apply(shape) + np.array([9, 8, 7])
    positions = np.stack([turned, shape])
    positions[0, :2] = positions[1, 5] = np.nan
    np.testing.assert_allclose(reference_shape(make_recording(positions)), shape, atol=1e-12)


def test_two_shared_markers_give_a_translation() -> None:
    shape = np.random.default_rng(2).normal(size=(4, 3))
    positions = np.stack([shape, shape + np.array([1, 2, 3])])
    positions[0, 3] = positions[1, 2] = positions[1, 1] = np.nan
    np.testing.assert_allclose(reference_shape(make_recording(positions)), shape, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_a_mirrored_face_is_not_turned_inside_out(seed: int) -> None:
    shape = np.random.default_rng(seed).normal(size=(5, 3))
    mirrored = shape * [1, 1, -1]
    positions = np.stack([shape, mirrored])
    positions[0, 4] = positions[1, 0] = np.nan
    result = reference_shape(make_recording(positions))
    volume = np.linalg.det(mirrored[1:4] - mirrored[4])
    assert np.isclose(np.linalg.det(shape[1:4] - result[4]), volume)


def test_a_marker_that_is_never_there_stays_missing() -> None:
    positions = np.zeros((3, 2, 3))
    positions[:, 1] = np.nan
    np.testing.assert_array_equal(
        np.isnan(reference_shape(make_recording(positions)))[:, 0], [0, 1]
    )
    for empty in (positions[:0], positions[:, :0], positions[:, 1:]):
        assert np.isnan(reference_shape(make_recording(empty))).all()
