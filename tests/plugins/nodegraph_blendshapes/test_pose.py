from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_blendshapes.pose import pose
from nodegraph_mocap import MarkerSet, Weights
from nodegraph_mocap.specimens import marker_sets, models, weights

MODEL = models()["complete"]
SET = marker_sets()["complete"]
WEIGHTS = weights()["complete"]


def test_a_pose_is_the_neutral_and_each_shape_as_much_as_its_weight() -> None:
    posed = pose(WEIGHTS, MODEL, SET)
    assert (posed.markers, posed.rate, posed.marker_set) == (MODEL.markers, WEIGHTS.rate, SET)
    for frame, given in zip(posed.positions, WEIGHTS.values, strict=True):
        expected = MODEL.neutral.copy()
        for weight, shape in zip(given, MODEL.shapes, strict=True):
            expected += weight * shape
        np.testing.assert_allclose(frame, expected, rtol=0, atol=1e-12)
    assert posed.measured.all()
    assert pose(WEIGHTS, MODEL).marker_set is None


def test_names_of_another_convention_and_order_mean_the_same_shapes() -> None:
    order = [2, 0, 1]
    other = Weights(
        values=WEIGHTS.values[:, order],
        names=("mouthSmile_R", "JawOpen", "mouth_smile_left"),
        rate=WEIGHTS.rate,
    )
    np.testing.assert_allclose(
        pose(other, MODEL).positions, pose(WEIGHTS, MODEL).positions, rtol=0, atol=1e-12
    )


def test_what_has_no_counterpart_is_left_out_and_named() -> None:
    weights = replace(WEIGHTS, names=("jawOpen", "TongueOut", "browInnerUp"))
    with pytest.warns(UserWarning) as caught:  # noqa: PT030  (two of them, both below)
        posed = pose(weights, MODEL)
    assert [str(warning.message) for warning in caught] == [
        "2 of 3 weights have no shape on the model, and are left out: TongueOut, browInnerUp",
        "2 of the model's 3 shapes have no weight, and stay at 0: mouthSmileLeft, mouthSmileRight",
    ]
    expected = MODEL.neutral + WEIGHTS.values[:, 0, None, None] * MODEL.shapes[0]
    np.testing.assert_allclose(posed.positions, expected, rtol=0, atol=1e-12)


def test_a_shape_with_or_without_sides_moves_what_its_counterparts_move() -> None:
    whole = Weights(values=WEIGHTS.values[:, :2], names=("jawOpen", "mouthSmile"), rate=60)
    with pytest.warns(UserWarning, match="count for the left and the right shape: mouthSmile"):
        posed = pose(whole, MODEL)
    both = replace(WEIGHTS, values=WEIGHTS.values[:, [0, 1, 1]])
    np.testing.assert_array_equal(posed.positions, pose(both, MODEL).positions)

    one = replace(MODEL, shapes=MODEL.shapes[:2], names=("jawOpen", "mouthSmile"))
    with pytest.warns(UserWarning, match="get the mean of a left and a right weight: mouthSmile"):
        posed = pose(WEIGHTS, one)
    mean = WEIGHTS.values[:, 1:].mean(axis=1)
    halves = replace(whole, values=np.stack([WEIGHTS.values[:, 0], mean], axis=1))
    np.testing.assert_array_equal(posed.positions, pose(halves, one).positions)


def test_nothing_in_common_is_an_error() -> None:
    weights = replace(WEIGHTS, names=("a", "b", "c"))
    message = "no shape in common: the weights have a, b, c, the model jawOpen, mouthSmileLeft, mou"
    with pytest.raises(ValueError, match=message):
        pose(weights, MODEL)


def test_a_frame_that_lacks_a_weight_is_missing() -> None:
    values = WEIGHTS.values.copy()
    values[3, 1] = values[3, 2] = values[9] = np.nan
    with pytest.warns(UserWarning, match="^2 of 40 frames lack a weight, .* the first is frame 3"):
        posed = pose(replace(WEIGHTS, values=values), MODEL)
    missing = np.isin(np.arange(40), [3, 9])
    np.testing.assert_array_equal(posed.present, ~missing[:, None] & np.ones(10, dtype=bool))
    np.testing.assert_array_equal(
        posed.positions[~missing], pose(WEIGHTS, MODEL).positions[~missing]
    )


@pytest.mark.filterwarnings("ignore:1 of ")
def test_a_missing_weight_that_the_model_does_not_know_does_no_harm() -> None:
    values = WEIGHTS.values.copy()
    values[:, 2] = np.nan
    weights = replace(WEIGHTS, values=values, names=("jawOpen", "mouthSmileLeft", "TongueOut"))
    assert pose(weights, MODEL).present.all()


def test_a_marker_set_of_another_face_is_an_error() -> None:
    with pytest.raises(ValueError, match="the marker set names chin, which the model lacks"):
        pose(WEIGHTS, MODEL, MarkerSet(markers=("chin",)))
