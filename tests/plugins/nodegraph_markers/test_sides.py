"""Left is told from right by names, and guessed from shape and movement."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_markers.mirror import face_axes, side_by_name


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("L_brow1", "R_brow1"),
        ("brow_left", "brow_right"),
        ("LeftBrow", "RightBrow"),
        ("Leyebrow_M", "Reyebrow_M"),
        ("Mouth_UpL1", "Mouth_UpR1"),
        ("Mouth_Lend", "Mouth_Rend"),
        ("LFHD", "RFHD"),
        ("browLeftInner", "browRightInner"),
        ("LEFT_EYE", "RIGHT_EYE"),
        ("ASISl", "ASISr"),
        ("L_brow2", "R_brow3"),  # numbered each side by itself
        ("left cheek 1", "cheek 4"),
        ("cheek3", "R_cheek1"),
    ],
)
def test_names_that_tell(left: str, right: str) -> None:
    assert side_by_name(left, right) == 1
    assert side_by_name(right, left) == -1


@pytest.mark.parametrize(
    ("first", "other"),
    [
        ("x1", "x2"),
        ("lip1", "chin"),
        ("rim1", "lid2"),
        ("LIP1", "EYE4"),
        ("t001", "t002"),
        ("L_brow1", "L_brow2"),
        ("cheek_l", "cheek_l2"),
    ],
)
def test_names_that_do_not_tell(first: str, other: str) -> None:
    assert side_by_name(first, other) == 0


def test_up_and_front_are_found_from_movement_in_any_pose() -> None:
    random = np.random.default_rng(4)
    aside, up = random.uniform(-60, 60, 40), random.uniform(-90, 90, 40)
    shape = np.stack([aside, up, 40 - aside**2 / 90], axis=1)
    motion = 6.0 - up / 20 + random.uniform(0, 1, 40)
    turn = Rotation.random(random_state=5).as_matrix()
    for sign in (1.0, -1.0):
        axes = face_axes(shape @ turn.T, sign * turn[:, 0], motion)
        assert axes.up @ turn[:, 1] > 0.95
        assert axes.front @ turn[:, 2] > 0.95
        assert axes.left @ turn[:, 0] > 0.95


def test_up_is_the_wider_end_of_a_face_that_is_not_known_to_move() -> None:
    shape = np.array([[50.0, 60, 0], [-50, 60, 0], [0, 70, 20], [0, 0, 30], [15, -70, 10]])
    shape = np.concatenate([shape, [[-15.0, -70, 10]]])
    axes = face_axes(shape, np.array([1.0, 0, 0]), None)
    assert axes.up[1] > 0.9
    assert axes.left[0] > 0.9
