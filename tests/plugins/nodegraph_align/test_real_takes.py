"""Head motion found in a take of which it is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_align.generalized import generalized
from nodegraph_align.huber import huber
from nodegraph_align.procrustes import procrustes
from nodegraph_align.trimmed import trimmed
from nodegraph_files.c3d import read_c3d
from nodegraph_files.npz import read_model_npz
from nodegraph_mocap import HeadMotion, Trajectories
from tests.studies import DATA, needs_recordings

Array = NDArray[np.float64]
FOLDER = DATA / "facecap"
LANDMARKS = (
    "M_brow2", "R_nose1", "L_eye1", "R_eye1", "L_nose1", "R_brow1", "L_brow1", "R_brow4",
)  # fmt: skip
"""Those that move least: 1.0 to 1.8 mm, root mean square."""

pytestmark = needs_recordings


class Known(NamedTuple):
    """A take, the face at rest, and where the head was."""

    take: Trajectories
    rest: Trajectories
    rotations: Array
    translations: Array


@pytest.fixture(scope="module")
def known() -> Known:
    model, take = read_model_npz(FOLDER / "model_60_markers.npz"), read_c3d(FOLDER / "take001.c3d")
    with np.load(FOLDER / "take001_truth.npz") as truth:
        rotations, translations = truth["head_rotation"], truth["head_translation"]
    rest = Trajectories(positions=model.neutral[None], markers=model.markers, rate=1.0)
    return Known(take, rest, rotations.astype(np.float64), translations.astype(np.float64))


def with_rigid_landmarks(known: Known) -> Trajectories:
    """The take, its landmarks where the head alone would have taken them."""
    positions = known.take.positions.copy()
    for name in LANDMARKS:
        place = known.rest.positions[0, known.rest.markers.index(name)]
        positions[:, known.take.markers.index(name)] = known.rotations @ place + known.translations
    return replace(known.take, positions=positions)


def degrees(motion: HeadMotion, known: Known) -> Array:
    apart = motion.rotations @ known.rotations.transpose(0, 2, 1) - np.eye(3)
    chord = np.linalg.norm(apart, axis=(1, 2)) / np.sqrt(8.0)
    return np.asarray(np.degrees(2.0 * np.arcsin(np.minimum(chord, 1.0))))


def millimetres(motion: HeadMotion, known: Known) -> float:
    """Root mean square distance of the face at rest, moved as found, from where it was."""
    rest = known.rest.positions[0]
    aligned = np.einsum("tij,mj->tmi", motion.rotations - known.rotations, rest)
    aligned += (motion.translations - known.translations)[:, None]
    return float(np.sqrt((aligned**2).sum(axis=2).mean()))


@pytest.mark.parametrize("align", [procrustes, trimmed, huber])
def test_head_motion_is_found_where_landmarks_are_rigid(known: Known, align: Any) -> None:
    motion = align(with_rigid_landmarks(known), known.rest, landmarks=LANDMARKS).head_motion
    np.testing.assert_allclose(motion.rotations, known.rotations, rtol=0, atol=1e-6)
    np.testing.assert_allclose(motion.translations, known.translations, rtol=0, atol=1e-4)


def test_landmarks_that_move_a_little_mislead_a_little(known: Known) -> None:
    motion = procrustes(known.take, known.rest, landmarks=LANDMARKS).head_motion
    assert degrees(motion, known).mean() == pytest.approx(0.41, abs=0.05)
    assert degrees(motion, known).max() == pytest.approx(0.81, abs=0.1)
    assert millimetres(motion, known) == pytest.approx(0.80, abs=0.1)


def test_a_mean_shape_does_as_well_as_the_neutral(known: Known) -> None:
    aligned = generalized(known.take, landmarks=LANDMARKS)
    onto = procrustes(aligned.reference, known.rest, landmarks=LANDMARKS).head_motion
    turned = aligned.head_motion.rotations
    motion = HeadMotion(
        rotations=turned @ onto.rotations[0],
        translations=turned @ onto.translations[0] + aligned.head_motion.translations,
        scales=aligned.head_motion.scales,
    )
    assert degrees(motion, known).mean() == pytest.approx(0.41, abs=0.05)


def test_what_is_left_is_the_expression_unless_the_first_frame_is_the_reference(
    known: Known,
) -> None:
    take = with_rigid_landmarks(known)
    own = procrustes(take, landmarks=LANDMARKS).aligned.positions
    aligned = procrustes(take, known.rest, landmarks=LANDMARKS).aligned.positions
    truth = (take.positions - known.translations[:, None]) @ known.rotations
    np.testing.assert_allclose(aligned, truth, rtol=0, atol=1e-4)
    assert np.sqrt(((own - truth) ** 2).sum(axis=2).mean()) > 2.0
