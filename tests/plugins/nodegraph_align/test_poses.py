"""Poses move a recording, lead back, and say what is doubtful."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_align import poses as module
from nodegraph_align import rigid_kernel
from nodegraph_align.poses import FEW, FITTED, LINE, MIRRORED, fitted, warn
from nodegraph_align.reference import reference_of
from nodegraph_mocap import Origin
from tests.plugins.nodegraph_align.heads import make_head, make_recording, run_moved


def warned(*arguments: Any) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warn(*arguments)
    return [str(warning.message) for warning in caught]


def test_codes_are_those_of_the_compiled_loops() -> None:
    names = ("FITTED", "MIRRORED", "FEW", "LINE")
    assert [getattr(module, name) for name in names] == [
        getattr(rigid_kernel, name) for name in names
    ]
    kinds = (rigid_kernel.AS_IT_IS, rigid_kernel.RMS, rigid_kernel.LEAST_SQUARES)
    assert tuple(module._CODES.values()) == kinds


def test_moving_keeps_what_is_known_of_samples_and_scales_sigma() -> None:
    rest, motion = make_head(frames=5)
    motion = replace(motion, scales=np.array([1.0, 0.5, 2.0, 1.25, 0.8]))
    take = run_moved(rest, motion)
    origin = np.full(take.origin.shape, Origin.REPAIRED, dtype=np.uint8)
    origin[2, 8] = Origin.FILLED
    take = replace(take, origin=origin, sigma=np.full(origin.shape, 0.3))
    actual = fitted(take, reference_of(take, rest, None)[0], "rms")
    aligned, back = actual.move(take)
    np.testing.assert_allclose(aligned.positions, np.repeat(rest.positions, 5, axis=0), atol=1e-10)
    np.testing.assert_array_equal(aligned.origin, origin)
    assert aligned.sigma is not None
    np.testing.assert_allclose(aligned.sigma, np.repeat(0.3 / motion.scales[:, None], 12, axis=1))
    for name in ("rotations", "translations", "scales"):
        np.testing.assert_allclose(getattr(back, name), getattr(motion, name), atol=1e-9)


def test_frames_that_are_not_fitted_stay_bit_for_bit() -> None:
    rest, motion = make_head(frames=3)
    take = run_moved(rest, motion)
    poses = fitted(take, reference_of(take, rest, None)[0], "none")
    poses.states[1], poses.states[2] = FEW, LINE
    aligned, back = poses.move(take)
    np.testing.assert_array_equal(aligned.positions[1:], take.positions[1:])
    np.testing.assert_array_equal(back.rotations[1:], np.tile(np.eye(3), (2, 1, 1)))
    assert not back.translations[1:].any()
    np.testing.assert_array_equal(back.scales, 1.0)
    assert np.abs(aligned.positions[0] - rest.positions[0]).max() < 1e-10


def test_doubts_are_counted() -> None:
    rest, motion = make_head(frames=6)
    positions = run_moved(rest, motion).positions.copy()
    positions[1, 0] = positions[2, 1:5] = positions[4, [0, 1]] = np.nan
    take = make_recording(positions)
    reference, _ = reference_of(take, rest, None)
    poses = fitted(take, reference, "none")
    assert poses.states.tolist() == [FITTED, FITTED, FEW, FITTED, FITTED, FITTED]
    poses.states[3], poses.states[5] = LINE, MIRRORED
    messages = warned(poses, take, reference, ["this first"])
    assert messages == [
        "this first; 2 of 6 frames (first 1) aligned by fewer than the 6 landmarks, 4 in the "
        "worst, as others are missing; 1 of 6 frames (first 2) left as they are, with fewer than "
        "3 landmarks; 1 of 6 frames (first 3) left as they are, with landmarks on a line; 1 of 6 "
        "frames (first 5) fit badly where a mirror image would fit well: have left and right "
        "changed places?"
    ]


def test_no_frame_fitted_is_refused() -> None:
    rest, motion = make_head(frames=2)
    take = run_moved(rest, motion)
    reference, _ = reference_of(take, rest, None)
    poses = fitted(take, reference, "none")
    poses.states[:] = FEW
    with pytest.raises(Refusal, match="no frame has 3 of the landmarks m0, m1, m2, m3, m4, m5"):
        warn(poses, take, reference, [])


def test_a_scale_that_there_is_not_is_reported_with_what_there_is() -> None:
    shape = np.eye(3)
    with pytest.raises(
        ValueError, match=r"no scale 'rsm'; did you mean 'rms'. there is: none, rms"
    ):
        module.fit(shape[None], np.arange(3), shape, np.ones((1, 3)), "rsm")  # type: ignore[arg-type]
