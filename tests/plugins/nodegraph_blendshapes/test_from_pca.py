from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_blendshapes.from_pca import from_pca
from nodegraph_mocap import BlendshapeModel, Trajectories
from nodegraph_mocap.specimens import recordings
from nodegraph_tables import info_of
from tests.plugins.recordings import make_recording, real_take
from tests.studies import needs_recordings

FACE = recordings()["complete"]


def frames(chosen: slice) -> Trajectories:
    positions, origin = FACE.positions[chosen], FACE.origin[chosen]
    return replace(FACE, positions=positions, origin=origin)


def solved(recording: Trajectories, model: BlendshapeModel) -> NDArray[np.float64]:
    """Return the (T, K) weights that fit best."""
    offsets = (recording.positions - model.neutral).reshape(recording.frames, -1)
    basis = model.shapes.reshape(len(model.names), -1)
    return np.asarray(np.linalg.lstsq(basis.T, offsets.T, rcond=None)[0].T)


def test_components_are_those_of_the_covariance_and_weight_1_a_standard_deviation() -> None:
    model, neutral, table = from_pca(FACE, components=4)
    flat = FACE.positions.reshape(FACE.frames, -1)
    sizes, axes = np.linalg.eigh(np.cov(flat.T, bias=True))
    for number in range(4):
        shape = model.shapes[number].ravel()
        assert np.linalg.norm(shape) == pytest.approx(np.sqrt(sizes[-1 - number]))
        assert abs(axes[:, -1 - number] @ shape) == pytest.approx(np.linalg.norm(shape))
    np.testing.assert_allclose(model.neutral, FACE.positions.mean(axis=0), atol=1e-12)
    np.testing.assert_array_equal(neutral.positions[0], model.neutral)
    assert neutral.marker_set == FACE.marker_set
    assert model.names == ("pc_1", "pc_2", "pc_3", "pc_4")
    weights = solved(FACE, model)
    np.testing.assert_allclose(weights.mean(axis=0), 0, atol=1e-9)
    np.testing.assert_allclose(weights.std(axis=0), 1)
    np.testing.assert_allclose(np.corrcoef(weights.T), np.eye(4), atol=1e-9)
    np.testing.assert_allclose(
        table["share"], (sizes / sizes.sum())[::-1][: len(table)], atol=1e-12
    )
    np.testing.assert_allclose(table["cumulative"], np.cumsum(table["share"]))
    assert table["cumulative"].iloc[-1] == pytest.approx(1)
    assert table["kept"].tolist() == [True] * 4 + [False] * (len(table) - 4)
    movement = [np.sqrt(np.mean(np.linalg.norm(shape, axis=1) ** 2)) for shape in model.shapes]
    np.testing.assert_allclose(table["movement"][:4], movement)
    message = f"The model's 4 shapes explain {100 * table['cumulative'][3]:.2f} % of the variance."
    assert list(info_of(table).notes) == [message]


@pytest.mark.parametrize("variance", [0.3, 0.9, 0.98, 1.0])
def test_as_few_components_as_keep_the_variance(variance: float) -> None:
    model, _, table = from_pca(FACE, variance=variance)
    count = len(model.names)
    assert table["cumulative"][count - 1] >= variance - 1e-9
    assert count == 1 or table["cumulative"][count - 2] < variance


def test_a_given_neutral_is_what_offsets_are_from() -> None:
    rest = replace(frames(slice(2)), positions=FACE.positions[:2] - 3.0)
    model = from_pca(FACE, rest.keep(FACE.markers[::-1]), components=3).model
    np.testing.assert_array_equal(model.neutral, FACE.positions[0] - 3.0)
    offsets = (FACE.positions - model.neutral).reshape(FACE.frames, -1)
    sizes = np.linalg.eigvalsh(offsets.T @ offsets / FACE.frames)[::-1]
    np.testing.assert_allclose((model.shapes**2).sum(axis=(1, 2)), sizes[:3])
    weights = solved(FACE, model)
    np.testing.assert_allclose((weights**2).mean(axis=0), 1)
    # all frames lie to one side of it
    assert weights[:, 0].mean() > 0.5


def test_one_frame_beside_a_neutral_is_one_component() -> None:
    scan = frames(slice(9, 10))
    rest = frames(slice(1))
    model = from_pca(scan, rest).model
    np.testing.assert_allclose(model.neutral + model.shapes[0], scan.positions[0], atol=1e-9)


def test_the_largest_weight_of_each_shape_is_positive() -> None:
    model = from_pca(FACE, variance=1.0).model
    for column in solved(FACE, model).T:
        assert column[np.argmax(np.abs(column))] > 0


def test_the_sign_does_not_hang_on_rounding_where_two_frames_are_as_far() -> None:
    random = np.random.default_rng(2)
    way = random.normal(0, 5, (1, 6, 3))
    positions = np.concatenate([-way, 0 * way, way]) + random.normal(0, 80, (6, 3))
    for shift in np.linspace(0, 500, 23):
        shape = from_pca(make_recording(positions + shift)).model.shapes[0]
        assert np.vdot(shape, way) < 0


@pytest.mark.parametrize("name", ["gaps", "all missing", "a frame without any marker"])
def test_missing_samples_are_refused_with_the_first(name: str) -> None:
    recording = recordings()[name]
    count = np.count_nonzero(~recording.present)
    frame, marker = np.argwhere(~recording.present)[0]
    message = (
        f"needs complete frames, but {count} samples are missing, the first in frame {frame}, "
        f"marker '{recording.markers[marker]}'; fill the recording first"
    )
    with pytest.raises(Refusal, match=message):
        from_pca(recording)


def test_what_does_not_differ_is_refused() -> None:
    rest = np.random.default_rng(0).normal(0, 1000, (1, 20, 3))
    for frames in (1, 2, 3, 100):
        with pytest.raises(Refusal, match="the frames do not differ: there is no component"):
            from_pca(make_recording(np.repeat(rest, frames, axis=0)))
    with pytest.raises(Refusal, match="needs frames: the recording has none"):
        from_pca(make_recording(np.zeros((0, 2, 3))))
    with pytest.raises(Refusal, match="needs frames: the recording has none"):
        from_pca(make_recording(np.zeros((4, 0, 3))))


@pytest.mark.parametrize(("frames", "markers", "there"), [(5, 9, 4), (40, 3, 9), (2, 1, 1)])
def test_more_components_than_there_are_is_refused(frames: int, markers: int, there: int) -> None:
    recording = make_recording(np.random.default_rng(1).normal(0, 50, (frames, markers, 3)))
    assert len(from_pca(recording, components=there).model.names) == there
    message = f"differ in {there} directions only; {there + 1} components were asked for"
    with pytest.raises(Refusal, match=message):
        from_pca(recording, components=there + 1)


@needs_recordings
@pytest.mark.parametrize("take", ["jaw", "cheeks"])
def test_a_recorded_face_has_few_directions(take: str) -> None:
    recording = real_take(f"animface/{take}")
    model, _, table = from_pca(recording)
    assert 7 <= len(model.names) <= 12
    assert table["cumulative"][len(model.names) - 1] >= 0.98


@pytest.mark.parametrize("setting", [{"components": 0}, {"variance": 0.0}, {"variance": 1.5}])
def test_settings_are_checked_in_plain_calls(setting: dict[str, Any]) -> None:
    (name,) = setting
    with pytest.raises(ValueError, match=f"{name} must be"):
        from_pca(FACE, **setting)
