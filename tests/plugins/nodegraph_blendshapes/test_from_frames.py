from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import Refusal
from nodegraph_blendshapes.from_frames import from_frames
from nodegraph_blendshapes.pose import pose
from nodegraph_mocap import MarkerSet, Origin, Trajectories, Weights
from nodegraph_mocap.specimens import recordings

FACE = recordings()["complete"]
CHOSEN = {"smile": 12, "jawOpen": 30}


def without(recording: Trajectories, frame: int, *markers: str) -> Trajectories:
    positions = recording.positions.copy()
    positions[frame, [recording.markers.index(name) for name in markers]] = np.nan
    lost = np.isnan(positions[..., 0])
    return recording.with_samples(positions, changed=lost, origin=Origin.MISSING)


def test_a_shape_is_the_offset_of_its_frame_from_the_neutral() -> None:
    model, neutral = from_frames(FACE, frames=CHOSEN)
    assert (model.names, model.markers) == (tuple(CHOSEN), FACE.markers)
    np.testing.assert_array_equal(model.neutral, FACE.positions[0])
    for shape, frame in zip(model.shapes, CHOSEN.values(), strict=True):
        np.testing.assert_array_equal(shape, FACE.positions[frame] - FACE.positions[0])
    assert (neutral.frames, neutral.rate, neutral.marker_set) == (1, 1.0, FACE.marker_set)
    np.testing.assert_array_equal(neutral.positions[0], model.neutral)


def test_the_neutral_may_come_from_another_recording_whatever_its_order() -> None:
    rest = replace(FACE, positions=FACE.positions + 2.0).keep(FACE.markers[::-1])
    model = from_frames(FACE, rest, frames=CHOSEN, neutral_frame=3).model
    np.testing.assert_array_equal(model.neutral, FACE.positions[3] + 2.0)
    np.testing.assert_array_equal(model.shapes[0], FACE.positions[12] - model.neutral)


def test_markers_that_only_the_neutral_has_are_left_out_and_named() -> None:
    kept = FACE.keep(FACE.markers[2:])
    with pytest.warns(UserWarning, match="2 markers of the neutral are not in the recording, and"):
        model = from_frames(kept, FACE, frames=CHOSEN).model
    assert model.markers == kept.markers


def test_a_neutral_that_lacks_a_marker_is_an_error() -> None:
    with pytest.raises(ValueError, match=r"the neutral has no marker 'nose'; it has brow_left, "):
        from_frames(FACE, FACE.keep(FACE.markers[:6] + FACE.markers[7:]), frames=CHOSEN)


@pytest.mark.parametrize(
    ("gap", "message"),
    [
        (12, r"shape 'smile': frame 12 lacks 2 of 10 markers \(lip_left, nose\); fill the"),
        (0, r"the neutral: frame 0 lacks 2 of 10 markers \(lip_left, nose\)"),
    ],
)
def test_a_missing_sample_is_refused_with_its_frame_and_markers(gap: int, message: str) -> None:
    with pytest.raises(Refusal, match=message):
        from_frames(without(FACE, gap, "nose", "lip_left"), frames=CHOSEN)


def test_a_missing_sample_in_another_frame_does_no_harm() -> None:
    model = from_frames(without(FACE, 13, "nose"), frames=CHOSEN).model
    np.testing.assert_array_equal(model.shapes, from_frames(FACE, frames=CHOSEN).model.shapes)


@pytest.mark.parametrize(
    ("chosen", "at_rest", "message"),
    [
        ({"smile": 40}, 0, "shape 'smile': there is no frame 40; there are 0 to 39"),
        ({"smile": -1}, 0, "shape 'smile': there is no frame -1; there are 0 to 39"),
        ({"smile": 3}, -41, "the neutral: there is no frame -41; there are 0 to 39"),
        ({"smile": 3}, 99, "the neutral: there is no frame 99; there are 0 to 39"),
        ({"jawOpen": 3, "jaw_open": 4}, 0, "shapes 'jawOpen' and 'jaw_open' have the same name"),
        ({"blink_L": 3, "BlinkLeft": 4}, 0, "shapes 'blink_L' and 'BlinkLeft' have the same name"),
    ],
)
def test_what_cannot_be_built_is_an_error(
    chosen: dict[str, int], at_rest: int, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        from_frames(FACE, frames=chosen, neutral_frame=at_rest)


def test_a_recording_without_frames_has_no_neutral() -> None:
    empty = Trajectories(positions=np.zeros((0, 2, 3)), markers=("a", "b"), rate=60.0)
    with pytest.raises(ValueError, match="the neutral: there is no frame 0; there are none"):
        from_frames(empty, frames={"smile": 0})


def test_shapes_that_are_the_same_or_nothing_are_reported() -> None:
    with pytest.warns(UserWarning, match="1 pairs of shapes are the same.*: smile and grin"):
        from_frames(FACE, frames={"smile": 5, "grin": 5, "jawOpen": 20})
    with pytest.warns(UserWarning, match="1 of 2 shapes move no marker: rest"):
        from_frames(FACE, frames={"rest": 0, "jawOpen": 20})


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 6))
def test_a_pose_by_one_weight_is_the_frame_that_it_was_built_from(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    positions = random.normal(0, 100, (count + 1, 5, 3))
    markers = tuple("abcde")
    recording = Trajectories(
        positions=positions, markers=markers, rate=50.0, marker_set=MarkerSet(markers=markers)
    )
    names = [f"shape{number}" for number in range(count)]
    model = from_frames(recording, frames={name: i + 1 for i, name in enumerate(names)}).model
    weights = Weights(
        values=np.vstack([np.zeros(count), np.eye(count)]), names=tuple(names), rate=50.0
    )
    np.testing.assert_allclose(pose(weights, model).positions, positions, rtol=0, atol=1e-12)
