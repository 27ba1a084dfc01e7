"""Weights with smoothness, beside one dense problem for the whole take."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from nodegraph import Refusal
from nodegraph_blendshapes.solve import smooth
from nodegraph_blendshapes.solve.weights import Bounds, limits, solve_weights
from nodegraph_mocap import BlendshapeModel, Trajectories
from tests.plugins.nodegraph_blendshapes.solve.statements import Matrix, at, face, posed
from tests.plugins.recordings import quietly

INF = float("inf")
FRAMES, SHAPES = 12, 4
VALUES = np.random.default_rng(0).uniform(-0.4, 1.4, (FRAMES, SHAPES))


def solved(recording: Trajectories, model: BlendshapeModel, **settings: object) -> Matrix:
    return quietly(solve_weights, recording, model, **settings).weights.values


def system(
    recording: Trajectories, model: BlendshapeModel, ridge: float, smoothness: float
) -> tuple[Matrix, Matrix]:
    """Every square of the sum as a row, for frames that all have a marker."""
    frames, count = recording.frames, len(model.names)
    rows, right = [], []
    for frame, marker in zip(*np.nonzero(recording.present), strict=True):
        for axis in range(3):
            row = np.zeros((frames, count))
            row[frame] = model.shapes[:, marker, axis]
            rows.append(row)
            right.append(recording.positions[frame, marker, axis] - model.neutral[marker, axis])
    for frame in range(frames):
        for shape in range(count):
            row = np.zeros((frames, count))
            row[frame, shape] = np.sqrt(ridge)
            rows.append(row)
            right.append(0.0)
            if frame:
                row = np.zeros((frames, count))
                row[frame, shape], row[frame - 1, shape] = np.sqrt([smoothness, smoothness])
                row[frame - 1, shape] *= -1
                rows.append(row)
                right.append(0.0)
    return np.array(rows).reshape(len(rows), -1), np.array(right)


def gappy(recording: Trajectories) -> Trajectories:
    hidden = np.random.default_rng(3).random(recording.origin.shape) < 0.3
    hidden[:, 0] = False
    positions = np.where(hidden[..., None], np.nan, recording.positions)
    return at(recording, positions)


@pytest.mark.parametrize("bounds", [(0.0, 1.0), (-0.2, 0.9), "nonnegative", "none"])
@pytest.mark.parametrize("smoothness", [1e-3, 3.0, 1e3])
@pytest.mark.parametrize("ridge", [0.0, 0.5])
def test_as_one_dense_problem(bounds: Bounds, smoothness: float, ridge: float) -> None:
    model, _, _ = face(VALUES)
    recording = gappy(posed(model, VALUES, noise=0.5))
    solution = solved(recording, model, bounds=bounds, smoothness=smoothness, ridge=ridge)
    low, high = limits(bounds)
    rows, right = system(recording, model, ridge, smoothness)
    expected = lsq_linear(rows, right, (low, high), "bvls", 1e-15, max_iter=500)
    np.testing.assert_allclose(solution, expected.x.reshape(solution.shape), rtol=0, atol=1e-8)
    gradient = (rows.T @ (rows @ solution.ravel() - right)).reshape(solution.shape)
    held = (solution == low) & (gradient > 0) | (solution == high) & (gradient < 0)
    assert np.abs(np.where(held, 0.0, gradient)).max() <= 1e-10 * np.abs(rows.T @ right).max()


def test_hardly_any_smoothness_is_none_and_much_of_it_is_one_expression() -> None:
    model, _, _ = face(VALUES)
    recording = posed(model, VALUES, noise=0.5)
    alone = solved(recording, model)
    np.testing.assert_allclose(solved(recording, model, smoothness=1e-9), alone, rtol=0, atol=1e-7)
    still = solved(recording, model, smoothness=1e7)
    assert np.ptp(still, axis=0).max() < 1e-3
    middle = solved(at(recording, recording.positions.mean(axis=0, keepdims=True)), model)
    np.testing.assert_allclose(still, np.broadcast_to(middle, still.shape), rtol=0, atol=1e-3)
    with pytest.raises(Refusal, match="try a larger ridge or less smoothness"):
        solved(recording, model, smoothness=1e12)


def test_a_frame_without_any_marker_splits_the_take() -> None:
    model, _, _ = face(VALUES)
    recording = posed(model, VALUES, noise=0.5)
    positions = recording.positions.copy()
    positions[5] = np.nan
    solution = solved(at(recording, positions), model, smoothness=4.0)
    assert np.isnan(solution[5]).all()
    for part in (slice(0, 5), slice(6, FRAMES)):
        alone = at(recording, recording.positions[part])
        expected = solved(alone, model, smoothness=4.0)
        np.testing.assert_allclose(solution[part], expected, rtol=0, atol=1e-9)


def test_a_hidden_shape_follows_from_the_frames_around() -> None:
    model, _, _ = face(VALUES)
    shapes = model.shapes.copy()
    shapes[1, 1:] = 0.0
    model = replace(model, shapes=shapes)
    values = np.clip(VALUES, 0.2, 0.8)
    recording = posed(model, values)
    positions = recording.positions.copy()
    positions[4:6, 0] = np.nan
    hidden = at(recording, positions)
    with pytest.warns(UserWarning, match=r"in 2 of 12 frames .* follows from .* around: s1 \(2\)"):
        solution = solve_weights(hidden, model, smoothness=1e-6)
    between = np.interp([4, 5], [3, 6], values[[3, 6], 1])
    np.testing.assert_allclose(solution.weights.values[4:6, 1], between, rtol=0, atol=5e-4)
    assert solution.residuals["unseen"].tolist() == [0] * 4 + [1] * 2 + [0] * 6


@pytest.mark.parametrize("shapes", [24, 36])
def test_more_shapes_than_coordinates(shapes: int) -> None:
    """Weights on their bounds, clean and tied: where exchanging alone goes round in circles."""
    values = np.clip(np.random.default_rng(1).normal(0, 1, (20, shapes)), 0, 1)
    model, recording, _ = face(values, markers=7)
    for bounds in ((0.0, 1.0), "nonnegative"):
        for smoothness in (1e-6, 1e-2, 1e3):
            solution = solved(recording, model, bounds=bounds, smoothness=smoothness)
            rows, right = system(recording, model, 0.0, smoothness)
            gradient = (rows.T @ (rows @ solution.ravel() - right)).reshape(solution.shape)
            high = 1.0 if isinstance(bounds, tuple) else INF
            held = (solution == 0.0) & (gradient > 0) | (solution == high) & (gradient < 0)
            limit = 1e-10 * np.abs(rows.T @ right).max()
            assert np.abs(np.where(held, 0.0, gradient)).max() <= limit


def test_what_rounding_hides_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    model, _, _ = face(VALUES)
    recording = posed(model, VALUES, noise=0.5)
    monkeypatch.setattr(smooth, "_nearest", lambda chain, weights: weights)
    with pytest.raises(Refusal, match=r"within rounding: a gradient of 1 of the largest at"):
        solve_weights(recording, model, smoothness=1.0)
