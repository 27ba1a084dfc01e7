"""The error of a head motion is the angle and the distance by which it was changed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_mocap import HeadMotion
from nodegraph_score.head_motion import head_motion
from nodegraph_tables import info_of


def motion(frames: int = 10) -> HeadMotion:
    rng = np.random.default_rng(0)
    return HeadMotion(
        rotations=Rotation.from_rotvec(rng.normal(0, 0.3, (frames, 3))).as_matrix(),
        translations=rng.normal(0, 5, (frames, 3)),
        scales=np.ones(frames),
    )


def test_each_error_is_reported_in_its_unit() -> None:
    truth = motion()
    angles = np.linspace(0.0, 9.0, 10)
    turns = Rotation.from_rotvec(angles[:, None] * [0.6, 0.0, 0.8], degrees=True).as_matrix()
    estimate = HeadMotion(
        rotations=turns @ truth.rotations,
        translations=truth.translations + np.array([0.0, 3.0, -4.0]),
        scales=np.full(10, 1.02),
    )
    table = head_motion(estimate, truth)
    assert table["frame"].tolist() == list(range(10))
    np.testing.assert_allclose(table["rotation"], angles, atol=1e-9)
    np.testing.assert_allclose(table["translation"], 5.0)
    np.testing.assert_allclose(table["scale"], 2.0)
    assert info_of(table).units["rotation"] == "degrees"


def test_a_mirror_image_is_refused() -> None:
    mirrored = replace(motion(), rotations=motion().rotations @ np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(ValueError, match="estimate, frame 0"):
        head_motion(mirrored, motion())
