"""Recorded performances whose weights are known, on the head that they are stored with."""

from __future__ import annotations

import warnings
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import get_node
from nodegraph_blendshapes.pose import pose
from nodegraph_blendshapes.solve.weights import solve_weights
from nodegraph_mocap import BlendshapeModel, Trajectories, Weights
from nodegraph_mocap.shape_names import matched
from tests.plugins.nodegraph_blendshapes.solve.statements import (
    FACECAP,
    Matrix,
    at,
    by_scipy,
    left,
    posed,
    stored_model,
)
from tests.plugins.recordings import quietly

pytestmark = pytest.mark.skipif(not FACECAP.is_dir(), reason="the recordings are not here")
UNSEEN = ("eyeLookUp_L", "eyeLookUp_R", "tongueOut")


@cache
def stored() -> tuple[Matrix, Matrix, Matrix]:
    """Weights, head rotations and translations of the take."""
    truth = np.load(FACECAP / "take001_truth.npz")
    return tuple(  # type: ignore[return-value]
        np.asarray(truth[name], dtype=np.float64)
        for name in ("weights", "head_rotation", "head_translation")
    )


def take() -> Trajectories:
    """The recording, with the stored head motion taken away."""
    recording = get_node("read.recording")(path=FACECAP / "take001.c3d")
    assert isinstance(recording, Trajectories)
    return at(recording, still(recording.positions))


def still(positions: Matrix) -> Matrix:
    """Head motion taken away: by the inverse, as rotations in float32 are not exact ones."""
    _, rotations, translations = stored()
    back = np.linalg.inv(rotations)
    return np.asarray(np.einsum("tij,tmj->tmi", back, positions - translations[:, None]))


def seen() -> NDArray[np.bool_]:
    return np.array([name not in UNSEEN for name in stored_model().names])


def weights_of(recording: Trajectories, model: BlendshapeModel, **settings: object) -> Matrix:
    return quietly(solve_weights, recording, model, **settings).weights.values


def test_the_recording_gives_them_but_for_its_own_rounding() -> None:
    """Its samples are float32, off by up to 1e-5 mm; the model tells 0.0375 mm per weight apart."""
    weights, _, _ = stored()
    recording, model = take(), stored_model()
    rounding = np.linalg.norm(recording.positions - posed(model, weights).positions, axis=(1, 2))
    columns = model.shapes[seen()].reshape(seen().sum(), -1)
    weakest = np.linalg.svd(columns, compute_uv=False)[-1]
    solution = weights_of(recording, model)
    apart = np.linalg.norm((solution - weights)[:, seen()], axis=1)
    assert weakest == pytest.approx(0.0375, abs=1e-3)
    assert (apart <= 2.0 * rounding / weakest).all()
    assert np.abs(solution - weights)[:, seen()].max() < 2e-4


@pytest.mark.parametrize(("bounds", "ridge"), [((0.0, 1.0), 0.0), ("none", 0.01)])
def test_noisy_markers_are_solved_as_by_scipy(bounds: object, ridge: float) -> None:
    model = stored_model()
    recording = posed(model, stored()[0], noise=0.05)
    solution = weights_of(recording, model, bounds=bounds, ridge=ridge)[:, seen()]
    columns = model.shapes[seen()].reshape(seen().sum(), -1)
    columns = np.hstack([columns, np.sqrt(ridge) * np.eye(len(columns))])
    targets = (recording.positions - model.neutral).reshape(recording.frames, -1)
    targets = np.pad(targets, ((0, 0), (0, len(columns))))
    low = -np.inf if bounds == "none" else 0.0
    high = 1.0 if isinstance(bounds, tuple) else np.inf
    assert left(columns, targets, solution, low, high) <= 1e-10
    some = slice(0, None, 30)
    expected = by_scipy(columns, targets[some], low, high)
    np.testing.assert_allclose(solution[some], expected, rtol=0, atol=1e-8)


def test_smoothness_meets_its_conditions() -> None:
    model = stored_model()
    recording = posed(model, stored()[0], noise=0.05)
    columns = model.shapes[seen()].reshape(seen().sum(), -1)
    targets = (recording.positions - model.neutral).reshape(recording.frames, -1)
    for smoothness in (0.0025, 1.0):
        solution = weights_of(recording, model, smoothness=smoothness)[:, seen()]
        gradient = (solution @ columns - targets) @ columns.T
        change = smoothness * np.diff(solution, axis=0)
        gradient[1:] += change
        gradient[:-1] -= change
        held = (solution == 0.0) & (gradient > 0) | (solution == 1.0) & (gradient < 0)
        limit = 1e-10 * np.abs(targets @ columns.T).max()
        assert np.abs(np.where(held, 0.0, gradient)).max() <= limit


@pytest.mark.parametrize(
    ("file", "lost", "spilled"), [("actor_a_60fps", 0, 0.0043), ("actor_b_30fps", 3, 0.128)]
)
def test_live_link_performances_come_back(file: str, lost: int, spilled: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        weights = get_node("read.weights")(path=FACECAP.parent / "livelink" / f"{file}.csv")
    assert isinstance(weights, Weights)
    model = stored_model()
    shapes = matched(weights.names, model.names)
    kept = [name for name in weights.names if shapes.get(name) not in (None, *UNSEEN)]
    driven = [weights.names.index(name) for name in kept]
    only = Weights(values=weights.values[:, driven], names=tuple(kept), rate=weights.rate)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # one weight of actor b is 1.0033
        solution = weights_of(pose(only, model), model, bounds=(0.0, 1.01))
        whole = weights_of(pose(weights, model), model, bounds=(0.0, 1.01))
    places = [model.names.index(shapes[name]) for name in kept]
    known = np.isfinite(only.values).all(axis=1)
    assert np.count_nonzero(~known) == lost
    assert len(places) == 49
    np.testing.assert_array_equal(np.isfinite(solution).all(axis=1), known)
    np.testing.assert_allclose(solution[known][:, places], only.values[known], rtol=0, atol=1e-10)
    # what the unseen shapes do, less than 0.5 mm each, is taken for some of the others
    assert np.nanmax(np.abs(whole[:, places] - only.values)) == pytest.approx(spilled, rel=0.1)


def test_gaps_hardly_change_clean_weights() -> None:
    weights, _, _ = stored()
    model = stored_model()
    positions = posed(model, weights).positions.copy()
    positions[np.random.default_rng(0).random(positions.shape[:2]) < 0.1] = np.nan
    positions[50] = np.nan
    solution = weights_of(at(posed(model, weights), positions), model)
    assert np.isnan(solution[50]).all()
    frames = np.arange(len(solution)) != 50
    apart = np.abs(solution - weights)[frames][:, seen()]
    assert np.median(apart.max(axis=1)) < 1e-9
    assert np.isfinite(apart).all()
