from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import MarkerSet, Trajectories
from nodegraph_mocap.view import frontal
from tests.plugins.nodegraph_plot import made_face
from tests.plugins.recordings import real_take
from tests.studies import needs_recordings

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}

# How the recording's axes can lie: rows are the images of left, up and forward.
Z_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], dtype=float)
Z_UP_FACING_X = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], dtype=float)
Y_UP_FACING_X = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]], dtype=float)
Y_DOWN = np.diag([1.0, -1.0, -1.0])


def turned(recording: Trajectories, rotation: NDArray[np.float64]) -> Trajectories:
    return Trajectories(
        positions=recording.positions @ rotation.T + [100.0, -300.0, 40.0],
        markers=recording.markers,
        rate=recording.rate,
        marker_set=recording.marker_set,
    )


def assert_upright(recording: Trajectories, rotation: NDArray[np.float64]) -> None:
    seen = frontal(turned(recording, rotation), "auto")
    assert seen.right == pytest.approx(rotation @ AXES["x"], abs=1e-12)
    assert seen.up == pytest.approx(rotation @ AXES["y"], abs=1e-12)


@pytest.mark.parametrize(
    "rotation", [np.eye(3), Z_UP, Z_UP_FACING_X, Y_UP_FACING_X, Y_DOWN], ids=str
)
def test_pairs_show_the_face_upright_however_the_axes_lie(rotation: NDArray[np.float64]) -> None:
    assert_upright(made_face.truth(), rotation)


@pytest.mark.parametrize("rotation", [np.eye(3), Z_UP, Z_UP_FACING_X, Y_UP_FACING_X], ids=str)
def test_without_pairs_y_or_z_is_up(rotation: NDArray[np.float64]) -> None:
    assert_upright(made_face.truth(marker_set=None), rotation)


@pytest.mark.parametrize("rotation", [np.eye(3), Z_UP], ids=["y up", "z up"])
def test_a_whole_head_that_is_deeper_than_high_is_upright(rotation: NDArray[np.float64]) -> None:
    half = np.abs(np.random.default_rng(5).normal(size=(40, 3)))
    half *= [70, 100, 115] / np.linalg.norm(half, axis=1, keepdims=True)
    half[:, 1:] *= np.random.default_rng(6).choice([-1, 1], (40, 2))
    nose = [[5.0, 0.0, 140.0], [5.0, -10.0, 145.0], [10.0, -15.0, 135.0]]
    left = np.concatenate([half, nose])
    points = np.concatenate([left, left * [-1, 1, 1]])
    names = [f"{side}{place}" for side in "lr" for place in range(len(left))]
    pairs = tuple((f"l{place}", f"r{place}") for place in range(len(left)))
    head = Trajectories(
        positions=points[np.newaxis],
        markers=tuple(names),
        rate=1.0,
        marker_set=MarkerSet(markers=tuple(names), pairs=pairs),
    )
    assert_upright(head, rotation)


@pytest.mark.parametrize("degrees", [0, 45, 60, 130, 200, 300])
def test_a_turned_head_is_seen_from_its_own_front(degrees: float) -> None:
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    rotation = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    seen = frontal(turned(made_face.truth(), rotation), "auto")
    assert seen.right @ rotation @ AXES["x"] > np.cos(np.radians(31))
    assert seen.up @ rotation @ AXES["y"] > np.cos(np.radians(31))
    assert seen.right @ seen.up == pytest.approx(0, abs=1e-12)


@needs_recordings
@pytest.mark.parametrize("name", ["animface/jaw", "animface/cheeks", "facecap/take001"])
def test_real_faces_are_upright_without_a_marker_set(name: str) -> None:
    recording = real_take(name)
    for rotation in (np.eye(3), Z_UP, Z_UP_FACING_X, Y_UP_FACING_X):
        assert_upright(recording, rotation)


def test_the_view_does_not_depend_on_what_was_filled() -> None:
    views = [frontal(made_face.filled(offset), "auto") for offset in (0.0, 500.0)]
    assert np.array_equal(views[0].centre, views[1].centre)
    assert np.array_equal(views[0].right, views[1].right)


def test_the_projection_reads_the_axes_that_are_asked_for() -> None:
    recording = made_face.truth()
    seen = frontal(recording, "-y+z")
    points = np.array([[1.0, 2.0, 3.0], [np.nan] * 3]) + seen.centre
    assert seen.project(points) == pytest.approx(
        np.array([[-2.0, 3.0], [np.nan, np.nan]]), nan_ok=True
    )


@pytest.mark.parametrize("view", ["front", "+x+x", "xy", "+x+w"])
def test_other_views_are_refused(view: str) -> None:
    with pytest.raises(ValueError, match="neither 'auto' nor two signed axes"):
        frontal(made_face.truth(), view)


def test_few_markers_are_seen_along_z() -> None:
    seen = frontal(made_face.truth().keep(("nose", "chin", "cheek_l")), "auto")
    assert seen.right.tolist() == [1, 0, 0]
    assert seen.up.tolist() == [0, 1, 0]


def test_a_recording_without_samples_has_a_view() -> None:
    positions = np.full((3, 5, 3), np.nan)
    empty = Trajectories(positions=positions, markers=tuple("abcde"), rate=60.0)
    assert frontal(empty, "auto").centre.tolist() == [0, 0, 0]
