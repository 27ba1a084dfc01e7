"""A take without its head motion: where its markers are, and which of them move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from nodegraph_markers.stillness import head_frame
from nodegraph_mocap import Trajectories
from nodegraph_mocap.specimens import recordings
from tests.plugins.nodegraph_markers.takes import face


def rigid(frames: int = 50) -> Trajectories:
    """Return a head that turns by up to half a circle, of which every third marker moves."""
    random = np.random.default_rng(3)
    shape = random.normal(0.0, 50.0, (12, 3))
    moving = np.zeros((frames, 12, 3))
    moving[:, ::3] = random.normal(0.0, 4.0, (frames, 4, 3))
    angles = np.linspace(0, np.pi, frames)[:, None] * [0.2, 0.9, 0.1]
    turns = Rotation.from_rotvec(angles).as_matrix()
    positions = (shape + moving) @ turns.transpose(0, 2, 1) + np.linspace(0, 300, frames)[
        :, None, None
    ]
    return Trajectories(positions=positions, markers=tuple("abcdefghijkl"), rate=60.0)


def test_the_markers_that_stay_where_they_are_do_not_move() -> None:
    motion = head_frame(rigid()).motion
    assert motion is not None
    assert motion[::3].min() > 4.0
    assert np.delete(motion, [0, 3, 6, 9]).max() < 1e-3


def test_missing_samples_leave_the_shape_as_it_is() -> None:
    whole = rigid()
    positions = whole.positions.copy()
    positions[:40, 1] = positions[::2, 4] = np.nan
    gappy = replace(whole, positions=positions, origin=np.isfinite(positions[..., 0]) * 1)
    shapes = [head_frame(shape).shape[[1, 2, 4, 5]] for shape in (whole, gappy)]
    apart = [np.linalg.norm(shape[:, None] - shape, axis=2) for shape in shapes]
    np.testing.assert_allclose(apart[0], apart[1], atol=1e-3)


def test_a_face_moves_as_it_does_without_its_head() -> None:
    synthetic = face(seed=0, seconds=3.0)
    motion = head_frame(synthetic.captured).motion
    turns, shifts = synthetic.head_motion.rotations, synthetic.head_motion.translations
    still = (synthetic.truth.positions - shifts[:, None]) @ turns
    # What is hidden cannot be told: the truth too is looked at where the recording has a sample.
    still = np.where(synthetic.captured.present[..., None], still, np.nan)
    away = np.linalg.norm(still - np.nanmedian(still, axis=0), axis=2)
    true = np.nanpercentile(away, 90, axis=0)
    assert motion is not None
    assert np.corrcoef(motion, true)[0, 1] > 0.99
    assert np.abs(motion - true).max() < 0.1 * true.max()


def test_a_marker_that_is_never_there_has_no_place() -> None:
    frame = head_frame(recordings()["a marker never seen"])
    assert frame.motion is not None
    assert np.isnan(frame.shape[3]).all()
    assert np.isinf(frame.motion[3])
    assert np.isfinite(np.delete(frame.shape, 3, axis=0)).all()
