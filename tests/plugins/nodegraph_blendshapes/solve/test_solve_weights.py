"""The node: what it returns, what it says, and what it does not take."""

from __future__ import annotations

import warnings
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph.testing import check_node
from nodegraph_blendshapes.solve import bounded
from nodegraph_blendshapes.solve.weights import solve_weights
from nodegraph_tables import info_of
from tests.plugins.nodegraph_blendshapes.solve.statements import at, face, least_norm, posed
from tests.plugins.recordings import quietly

FRAMES = 20
VALUES = np.random.default_rng(0).uniform(0, 1, (FRAMES, 4))


@pytest.mark.parametrize(
    "settings",
    [{"bounds": "none", "ridge": 0.5}, {"smoothness": 2.0}],
)
def test_it_keeps_its_promises(settings: dict[str, object]) -> None:
    check_node(get_node("solve.weights"), settings=settings)


@pytest.mark.parametrize("bounds", [(0.0, 1.0), (-0.2, 1.5), "nonnegative", "none"])
def test_weights_come_back(bounds: Any) -> None:
    model, recording, weights = face(VALUES)
    solution = solve_weights(recording, model, bounds=bounds)
    np.testing.assert_allclose(solution.weights.values, VALUES, rtol=0, atol=1e-12)
    assert (solution.weights.names, solution.weights.rate) == (weights.names, weights.rate)
    assert solution.residuals["rms"].max() < 1e-12
    assert list(info_of(solution.residuals).notes) == []


def test_the_table_beside_plain_loops() -> None:
    model, _, _ = face(VALUES)
    noisy = posed(model, np.random.default_rng(1).uniform(-0.5, 1.5, (FRAMES, 4)), noise=1.0)
    positions = noisy.positions.copy()
    positions[3, [0, 5]] = positions[8] = np.nan
    solution = quietly(solve_weights, at(noisy, positions), model)
    values, table = solution.weights.values, solution.residuals
    for frame in range(FRAMES):
        row = table.iloc[frame]
        apart = {}
        for place, marker in enumerate(model.markers):
            there = model.neutral[place].copy()
            for shape in range(4):
                there += values[frame, shape] * model.shapes[shape, place]
            distance = float(np.linalg.norm(positions[frame, place] - there))
            if np.isfinite(distance):
                apart[marker] = distance
        assert (row["frame"], row["markers"], row["missing"]) == (frame, len(apart), 8 - len(apart))
        assert row["at_low"] == sum(value == 0.0 for value in values[frame])
        assert row["at_high"] == sum(value == 1.0 for value in values[frame])
        if apart:
            squares = [value**2 for value in apart.values()]
            assert row["rms"] == pytest.approx(np.sqrt(sum(squares) / len(squares)), rel=1e-12)
            assert row["max"] == pytest.approx(max(apart.values()), rel=1e-12)
            assert row["worst"] == max(apart, key=lambda marker: apart[marker])
        else:
            assert np.isnan(row[["rms", "max"]].astype(float)).all()
            assert row["worst"] == ""
    assert table["at_low"].sum() > 0
    assert table["at_high"].sum() > 0


def test_everything_that_is_left_out_is_reported() -> None:
    model, recording, _ = face(VALUES)
    shapes = model.shapes.copy()
    shapes[1, 1:] = 0.0
    shapes[3] = 0.1
    model = replace(model, shapes=shapes)
    positions = posed(model, VALUES).positions.copy()
    positions[2:5, 0] = positions[9] = np.nan
    recording = replace(at(recording, positions), markers=(*model.markers[:7], "other"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        solution = solve_weights(recording, model)
    notes = [str(warning.message) for warning in caught]
    assert notes == [
        "1 of 8 markers of the recording are left out, as only the recording has them: other",
        "1 of 8 markers of the model are left out, as only the model has them: m7",
        "1 of 4 shapes move no marker of the recording by 0.5 mm and cannot be seen; their weight "
        "is 0: s3",
        "in 3 of 20 frames the markers by which a shape moves 0.5 mm are missing; its weight there "
        "is 0: s1 (3)",
        "1 of 20 frames have none of the model's markers, and no weights; the first is frame 9",
    ]
    assert list(info_of(solution.residuals).notes) == [f"{note}." for note in notes]
    assert (solution.weights.values[:, 3][np.arange(FRAMES) != 9] == 0.0).all()
    assert (solution.weights.values[2:5, 1] == 0.0).all()


def test_identical_shapes_share_and_ties_have_the_least_norm() -> None:
    model, recording, _ = face(VALUES, markers=1)
    solution = solve_weights(recording, model)
    columns = model.shapes.reshape(4, -1)
    for values in solution.weights.values:
        shortest = least_norm(columns, values, 0.0, 1.0)
        assert values @ values == pytest.approx(shortest @ shortest, rel=1e-7)


def test_what_could_not_be_determined_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    model, _, _ = face(VALUES)
    recording = posed(model, 2.0 * VALUES - 0.5, noise=0.5)
    monkeypatch.setattr(bounded, "_ROUNDS", 1)
    with pytest.warns(UserWarning, match=r"in \d+ of 20 frames the weights of least squares could"):
        solution = solve_weights(recording, model)
    lost = np.isnan(solution.weights.values).all(axis=1)
    assert lost.any()
    np.testing.assert_array_equal(lost, np.isnan(solution.residuals["rms"]))


def test_halves_and_threads_give_what_the_whole_gives() -> None:
    model, _, _ = face(np.random.default_rng(2).uniform(-0.5, 1.5, (FRAMES, 9)), markers=6)
    recording = posed(model, np.random.default_rng(3).uniform(-0.5, 1.5, (400, 9)), noise=0.5)
    whole = solve_weights(recording, model).weights.values
    halves = [
        solve_weights(at(recording, recording.positions[part]), model).weights.values
        for part in (slice(0, 123), slice(123, 400))
    ]
    np.testing.assert_allclose(np.concatenate(halves), whole, rtol=0, atol=1e-12)
    with ThreadPoolExecutor(4) as pool:
        at_once = list(pool.map(lambda _: solve_weights(recording, model).weights.values, range(8)))
    for first in at_once:
        np.testing.assert_array_equal(first, whole)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"bounds": (1.0, 0.0)}, "bounds must be two numbers"),
        ({"ridge": -1.0}, "ridge must be from 0 to 1e\\+12 mm\\^2, got -1"),
        ({"smoothness": float("inf")}, "smoothness must be from 0 to 1e\\+12 mm"),
        ({"smoothness": float("nan")}, "smoothness must be from 0 to 1e\\+12 mm"),
    ],
)
def test_nonsense_settings_are_named(settings: dict[str, Any], text: str) -> None:
    model, recording, _ = face(VALUES)
    with pytest.raises(ValueError, match=text):
        solve_weights(recording, model, **settings)


def test_no_shape_is_seen() -> None:
    model, recording, _ = face(VALUES)
    for settings in ({}, {"smoothness": 1.0}, {"bounds": "none"}):
        with pytest.warns(UserWarning, match="4 of 4 shapes move no marker"):
            solution = solve_weights(
                recording, replace(model, shapes=0.01 * model.shapes), **settings
            )
        np.testing.assert_array_equal(solution.weights.values, 0.0)
