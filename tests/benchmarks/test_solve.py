"""Weights of 52 shapes at 60 markers: all frames at once, beside loops over SciPy's solvers.

`lsq_linear` (``bvls``) solves the same problem, `nnls` the one without an upper bound. Both are
given the matrix as they come. A performance is smooth, so that most weights that are at a bound
stay there; shuffled, each frame is a stranger to the one before.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_blendshapes.solve.bounded import least_squares
from nodegraph_blendshapes.solve.weights import solve_weights
from nodegraph_mocap import BlendshapeModel, Trajectories
from tests.benchmarks.conftest import Clock

FRAMES, MARKERS, SHAPES, FEW = 600, 60, 52, 60
INF = float("inf")
CASE = "weights of 52 shapes at 60 markers"
Matrix = NDArray[np.float64]


def face(*, shuffled: bool = False) -> tuple[BlendshapeModel, Trajectories]:
    """Shapes of which each moves some markers, and weights that rise, rest and fall."""
    random = np.random.default_rng(0)
    reach = random.gamma(0.5, 1.0, (SHAPES, MARKERS, 1))
    names = tuple(f"m{number}" for number in range(MARKERS))
    model = BlendshapeModel(
        neutral=random.normal(0, 50, (MARKERS, 3)),
        shapes=reach * random.normal(0, 3, (SHAPES, MARKERS, 3)),
        names=tuple(f"s{number}" for number in range(SHAPES)),
        markers=names,
    )
    time = np.arange(FRAMES)[:, None] / 30.0
    pace, phase = random.uniform(0.5, 3.0, SHAPES), random.uniform(0.0, 6.0, SHAPES)
    values = np.clip(0.2 + 0.6 * np.sin(pace * time + phase), 0.0, 1.0)
    if shuffled:
        random.shuffle(values)
    positions = model.neutral + np.tensordot(values, model.shapes, axes=1)
    positions += random.normal(0, 0.2, positions.shape)
    return model, Trajectories(positions=positions, markers=names, rate=30.0)


def system(*, shuffled: bool = False) -> tuple[Matrix, Matrix]:
    model, recording = face(shuffled=shuffled)
    targets = (recording.positions - model.neutral).reshape(FRAMES, -1)
    return model.shapes.reshape(SHAPES, -1), targets


def with_lsq_linear(columns: Matrix, targets: Matrix) -> Matrix:
    from scipy.optimize import lsq_linear

    return np.array([lsq_linear(columns.T, column, (0.0, 1.0), "bvls").x for column in targets])


def with_nnls(columns: Matrix, targets: Matrix) -> Matrix:
    from scipy.optimize import nnls

    return np.array([nnls(columns.T, column)[0] for column in targets])


PEERS: dict[str, tuple[float, Callable[[Matrix, Matrix], Matrix]]] = {
    "SciPy lsq_linear, bvls, frame by frame": (1.0, with_lsq_linear),
    "SciPy nnls, frame by frame": (INF, with_nnls),
}


def column(high: float, shuffled: bool) -> str:
    bounds = "[0, 1]" if high == 1.0 else "nonnegative"
    return f"us/frame, {bounds}{', shuffled' if shuffled else ''}"


def left(columns: Matrix, targets: Matrix, weights: Matrix, high: float) -> float:
    gradient = (weights @ columns - targets) @ columns.T
    held = (weights == 0.0) & (gradient > 0) | (weights == high) & (gradient < 0)
    sizes = np.outer(np.linalg.norm(targets, axis=1), np.linalg.norm(columns, axis=1))
    return float((np.abs(np.where(held, 0.0, gradient)) / sizes).max())


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize("high", [1.0, INF])
def test_all_frames_at_once(high: float, shuffled: bool, clock: Clock, tables: Any) -> None:
    from threadpoolctl import threadpool_limits

    columns, targets = system(shuffled=shuffled)
    with threadpool_limits(1):
        result = clock(
            CASE,
            "nodegraph",
            column(high, shuffled),
            lambda: least_squares(columns, targets, 0.0, high),
            per=FRAMES,
            rounds=10,
        )
    worst = left(columns, targets, result.weights, high)
    case = "largest relative KKT residual, 1e-15"
    tables.put(case, "nodegraph", column(high, shuffled).removeprefix("us/frame, "), worst * 1e15)
    assert worst <= 1e-10


@pytest.mark.parametrize("shuffled", [False, True])
@pytest.mark.parametrize("name", PEERS)
def test_loops_over_scipy(name: str, shuffled: bool, clock: Clock) -> None:
    from threadpoolctl import threadpool_limits

    high, peer = PEERS[name]
    columns, targets = system(shuffled=shuffled)
    few = targets[:FEW]
    with threadpool_limits(1):
        result = clock(
            CASE, name, column(high, shuffled), lambda: peer(columns, few), per=FEW, rounds=3
        )
    expected = least_squares(columns, few, 0.0, high).weights
    np.testing.assert_allclose(result, expected, rtol=0, atol=1e-7)


@pytest.mark.parametrize("smoothness", [0.0, 0.04])
def test_whole_node(smoothness: float, clock: Clock) -> None:
    from threadpoolctl import threadpool_limits

    model, recording = face()
    with threadpool_limits(1):
        result = clock(
            "solve.weights, 600 frames of 52 shapes at 60 markers",
            "nodegraph",
            f"us/frame, smoothness {smoothness:g}",
            lambda: solve_weights(recording, model, smoothness=smoothness),
            per=FRAMES,
            rounds=2 if smoothness else 5,
        )
    assert result.residuals["rms"].max() < 1.0


def test_fewer_coordinates_than_shapes(clock: Clock) -> None:
    """Of a few selected markers: ties, of which the shortest weights are taken."""
    from threadpoolctl import threadpool_limits

    columns, targets = system()
    columns, targets = columns[:, :36], targets[:, :36]
    case = "weights of 52 shapes at 12 markers, the shortest"
    with threadpool_limits(1):
        result = clock(
            case,
            "nodegraph",
            "us/frame",
            lambda: least_squares(columns, targets, 0.0, 1.0),
            per=FRAMES,
            rounds=2,
        )
    assert not result.unsolved.any()
    assert left(columns, targets, result.weights, 1.0) <= 1e-10
