"""The frame that others are aligned to."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_align.reference import check_shape, reference_of
from tests.plugins.nodegraph_align.heads import make_recording


def scattered(frames: int = 5, markers: int = 6) -> np.ndarray:
    return np.random.default_rng(0).normal(0, 50, (frames, markers, 3))


def test_first_frame_with_all_landmarks_whatever_else_it_lacks() -> None:
    positions = scattered()
    positions[0, 1] = positions[1, [0, 2]] = positions[2, 5] = np.nan
    sigma = np.where(np.isnan(positions[..., 0]), np.nan, np.arange(5.0)[:, None])
    take = make_recording(positions, stable=4, sigma=sigma)
    for reference in (None, take):
        actual, notes = reference_of(take, reference, None)
        np.testing.assert_array_equal(actual.frame.positions, positions[2:3])
        np.testing.assert_array_equal(actual.frame.origin, take.origin[2:3])
        np.testing.assert_array_equal(actual.frame.sigma, sigma[2:3])
        np.testing.assert_array_equal(actual.shape, positions[2, :4])
        assert actual.landmarks == ("m0", "m1", "m2", "m3")
        assert actual.frame.marker_set is take.marker_set
        assert not notes


def test_a_take_without_a_frame_that_has_all_is_refused() -> None:
    positions = scattered()
    positions[np.arange(5), np.arange(5)] = positions[0, 1] = np.nan
    with pytest.raises(Refusal, match=r"all 6 landmarks: the fullest, frame 1, lacks m1; give a"):
        reference_of(make_recording(positions), None, None)


def test_a_reference_that_lacks_landmarks_does_with_what_its_fullest_frame_has() -> None:
    take, positions = make_recording(scattered()), scattered(3)
    positions[0, [0, 1]] = positions[1, 4] = positions[2, 3] = np.nan
    actual, notes = reference_of(take, make_recording(positions), None)
    assert actual.landmarks == ("m0", "m1", "m2", "m3", "m5")
    np.testing.assert_array_equal(actual.shape, positions[1, [0, 1, 2, 3, 5]])
    assert notes == ["1 landmarks are missing in the reference and are none: m4"]


def test_references_that_will_not_do() -> None:
    take, few = make_recording(scattered()), scattered(1)
    few[0, :4] = np.nan
    with pytest.raises(Refusal, match="needs 3 landmarks in the frame to align to, which has 2"):
        reference_of(take, make_recording(few), None)
    with pytest.raises(Refusal, match="there is none"):
        reference_of(take, make_recording(np.empty((0, 6, 3))), None)
    with pytest.raises(Refusal, match="there is none"):
        reference_of(make_recording(np.empty((0, 6, 3))), None, None)


@pytest.mark.parametrize("far", [0.0, 1e4])
def test_shapes_that_tell_no_turn(far: float) -> None:
    random = np.random.default_rng(0)
    line = np.outer(random.normal(0, 50, 6), [1.0, 2.0, -1.0]) + random.normal(0, 0.1, (6, 3))
    with pytest.raises(Refusal, match="lie on a line"):
        check_shape(line + far)
    with pytest.raises(Refusal, match="all in one place"):
        check_shape(np.full((4, 3), 0.1 + far))
    check_shape(line + np.outer([0.0, 9.0, 0.0, 9.0, 0.0, 9.0], [2.0, -1.0, 0.0]) + far)
