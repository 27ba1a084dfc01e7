"""Errors of weights, beside plain loops."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_mocap import Selection, Weights
from nodegraph_score.weights_mse import UNITS, weights_mse
from nodegraph_tables import info_of
from tests.plugins.recordings import quietly

COLUMNS = [
    "mse", "rmse", "max", "frames", "missing", "shapes", "worst", "worst_mse", "shared",
    "shared_mse",
]  # fmt: skip


def weights(names: str = "abcd", *, frames: int = 9, seed: int = 0) -> Weights:
    values = np.random.default_rng(seed).uniform(0, 1, (frames, len(names)))
    return Weights(values=values, names=tuple(names), rate=60.0)


def test_every_number_by_a_plain_loop() -> None:
    estimate, reference = weights(), weights(seed=1)
    values = estimate.values.copy()
    values[3, 1] = values[7] = np.nan
    estimate = replace(estimate, values=values)
    with pytest.warns(UserWarning, match="^2 of 9 frames lack a weight and are not compared$"):
        table = weights_mse(estimate, reference)
    assert list(table.columns) == COLUMNS
    squares: dict[str, list[float]] = {name: [] for name in "abcd"}
    for frame in range(9):
        if frame not in (3, 7):
            for place, name in enumerate("abcd"):
                error = values[frame, place] - reference.values[frame, place]
                squares[name].append(float(error) ** 2)
    every = [value for of_shape in squares.values() for value in of_shape]
    (row,) = table.to_dict("records")
    mse = sum(every) / len(every)
    by_shape = {name: sum(of_shape) / 7 for name, of_shape in squares.items()}
    assert row["mse"] == pytest.approx(mse, rel=1e-12)
    assert row["rmse"] == pytest.approx(mse**0.5, rel=1e-12)
    assert row["max"] == pytest.approx(max(every) ** 0.5, rel=1e-12)
    assert (row["frames"], row["missing"], row["shapes"], row["shared"]) == (7, 2, 4, 4)
    assert row["shared_mse"] == row["mse"]
    assert row["worst"] == max(by_shape, key=lambda name: by_shape[name])
    assert row["worst_mse"] == pytest.approx(max(by_shape.values()), rel=1e-12)
    assert list(info_of(table).notes) == ["2 of 9 frames lack a weight and are not compared."]
    assert info_of(table).units == UNITS


def test_a_frame_that_the_reference_lacks_is_not_compared() -> None:
    estimate, reference = weights(), weights(seed=1)
    values = reference.values.copy()
    values[:, 2] = np.nan
    table = quietly(weights_mse, estimate, replace(reference, values=values))
    assert (table["frames"][0], table["missing"][0], table["worst"][0]) == (0, 9, "")
    assert np.isnan(table[["mse", "rmse", "max", "worst_mse", "shared_mse"]].to_numpy()).all()


def test_the_same_weights_have_no_error_and_the_first_of_equals_is_worst() -> None:
    (row,) = weights_mse(weights(), weights()).to_dict("records")
    assert (row["mse"], row["max"], row["worst"]) == (0.0, 0.0, "a")


def test_shapes_are_matched_in_any_order_and_convention() -> None:
    reference = replace(weights(), names=("eyeBlink_L", "jawOpen", "tongueOut", "eyeBlink_R"))
    estimate = replace(
        weights(),
        names=("TongueOut", "EyeBlinkRight", "EyeBlinkLeft", "JawOpen"),
        values=reference.values[:, [2, 3, 0, 1]] + [0.0, 0.0, 0.5, 0.0],
    )
    (row,) = weights_mse(estimate, reference).to_dict("records")
    assert row["mse"] == pytest.approx(0.25 / 4, rel=1e-12)
    assert (row["worst"], row["shapes"]) == ("eyeBlink_L", 4)


def test_a_shape_without_sides_is_compared_with_both() -> None:
    reference = replace(weights("abc"), names=("browInnerUp_L", "browInnerUp_R", "jawOpen"))
    whole = Weights(values=reference.values[:, 1:], names=("BrowInnerUp", "jawOpen"), rate=60)
    with pytest.warns(UserWarning, match="1 weights without sides .*BrowInnerUp"):
        row = weights_mse(whole, reference).iloc[0]
    left = whole.values[:, 0] - reference.values[:, 0]
    assert row["mse"] == pytest.approx(np.mean(left**2) / 3)
    assert (row["shapes"], row["shared"]) == (3, 3)


def test_a_shape_that_one_lacks_is_0_there() -> None:
    estimate, reference = weights("abx"), weights("abcd", seed=1)
    with pytest.warns(UserWarning, match="shapes only the") as caught:
        table = weights_mse(estimate, reference)
    assert [str(warning.message) for warning in caught] == [
        "1 of 5 shapes only the estimate has; they are 0 in the other: x",
        "2 of 5 shapes only the reference has; they are 0 in the other: c, d",
    ]
    errors = np.concatenate(
        [
            estimate.values[:, :2] - reference.values[:, :2],
            -reference.values[:, 2:],
            estimate.values[:, 2:],
        ],
        axis=1,
    )
    assert table["mse"][0] == pytest.approx(np.square(errors).mean(), rel=1e-12)
    assert table["shapes"][0] == 5
    assert table["shared_mse"][0] == pytest.approx(np.square(errors[:, :2]).mean(), rel=1e-12)
    assert table["shared"][0] == 2


def test_a_selection_tells_how_many_markers() -> None:
    table = weights_mse(weights(), weights(seed=1), Selection(chosen=("m1", "m7", "m3")))
    assert list(table.columns) == [*COLUMNS, "markers"]
    assert table["markers"][0] == 3


def test_two_names_of_one_shape_are_refused() -> None:
    twice = replace(weights("ab"), names=("eyeBlinkLeft", "eyeBlink_L"))
    with pytest.raises(ValueError, match="'eyeBlinkLeft' and 'eyeBlink_L' both mean"):
        weights_mse(twice, replace(weights("a"), names=("EyeBlinkLeft",)))
