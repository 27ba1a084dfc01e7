from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_mocap import HeadMotion
from nodegraph_mocap.player.panels import panel_of, posed
from nodegraph_mocap.specimens import animations
from tests.plugins.nodegraph_plot import made_face


def test_all_that_was_measured_lies_in_the_picture() -> None:
    face = made_face.truth()
    panel = panel_of("a", face, "auto")
    seen = (face.positions - panel.centre) @ np.stack([panel.right, panel.up], axis=1)
    assert 0.8 * panel.radius < np.abs(seen).max() < panel.radius


def test_a_wild_fill_does_not_shrink_the_face() -> None:
    near, far = (panel_of("a", made_face.filled(offset), "auto") for offset in (0.0, 5000.0))
    assert near.radius == far.radius
    assert np.array_equal(near.centre, far.centre)


def test_a_head_is_seen_from_the_front_and_lies_in_the_picture() -> None:
    moved = animations()["complete"]
    turn = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    frames = moved.frames
    motion = HeadMotion(
        rotations=np.tile(turn, (frames, 1, 1)),
        translations=np.linspace([0, 0, 0], [300.0, 0, 0], frames),
        scales=np.full(frames, 2.0),
    )
    panel = panel_of("a", replace(moved, head_motion=motion), "auto")
    points = posed(replace(moved, head_motion=motion), moved.head.vertices)
    expected = 2 * moved.head.vertices @ turn.T + [300.0, 0, 0]
    assert points[-1] == pytest.approx(expected)
    seen = (points - panel.centre) @ np.stack([panel.right, panel.up], axis=1)
    assert 0.8 * panel.radius < np.abs(seen).max() < panel.radius
    assert np.cross(panel.right, panel.up) == pytest.approx([0, 0, 1])
