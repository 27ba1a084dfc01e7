"""A quadratic function over frames that hang together, beside its whole matrix."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from nodegraph_blendshapes.solve.chain import Chain
from nodegraph_blendshapes.solve.smooth import interior

INF = float("inf")
BOUNDS = [(0.0, 1.0), (-0.5, 1.0), (0.0, INF)]


def chain(low: float = 0.0, high: float = 1.0, *, smoothness: float = 2.0, seed: int = 0) -> Chain:
    """Seven frames of four weights in three pieces, with three grams."""
    random = np.random.default_rng(seed)
    columns = random.normal(size=(3, 4, 9))
    return Chain(
        grams=columns @ columns.transpose(0, 2, 1),
        which=np.array([0, 0, 1, 0, 2, 2, 0]),
        coupled=np.array([False, True, True, False, True, False, True]),
        linear=random.normal(0, 5, (7, 4)),
        low=low,
        high=high,
        smoothness=smoothness,
    )


def whole(problem: Chain) -> NDArray[np.float64]:
    """The matrix H, an entry at a time."""
    frames, count = problem.linear.shape
    solution = np.zeros((frames, count, frames, count))
    for frame in range(frames):
        solution[frame, :, frame] = problem.grams[problem.which[frame]]
    for frame in map(int, np.flatnonzero(problem.coupled)):
        for k in range(count):
            solution[frame, k, frame, k] += problem.smoothness
            solution[frame - 1, k, frame - 1, k] += problem.smoothness
            solution[frame, k, frame - 1, k] -= problem.smoothness
            solution[frame - 1, k, frame, k] -= problem.smoothness
    return solution.reshape(frames * count, -1)


def expected(problem: Chain) -> NDArray[np.float64]:
    """The least by SciPy, of the squares that have this matrix."""
    root = np.linalg.cholesky(whole(problem)).T
    target = np.linalg.solve(root.T, problem.linear.ravel())
    bounds = (problem.low, problem.high)
    return lsq_linear(root, target, bounds, "bvls", 1e-15, max_iter=500).x.reshape(7, 4)


@pytest.mark.parametrize(("low", "high"), [*BOUNDS, (-INF, INF)])
@pytest.mark.parametrize("seed", range(5))
def test_exchanging_finds_the_least(low: float, high: float, seed: int) -> None:
    problem = chain(low, high, seed=seed)
    solution = problem.exchanged(np.full((7, 4), 0.25))
    assert solution is not None
    np.testing.assert_allclose(solution, expected(problem), rtol=0, atol=1e-9)
    left = problem.inwards(solution, problem.gradient(solution))
    assert np.abs(left).max() <= 1e-13 * problem.size


@pytest.mark.parametrize(("low", "high"), BOUNDS)
@pytest.mark.parametrize("seed", range(5))
def test_the_least_from_within(low: float, high: float, seed: int) -> None:
    problem = chain(low, high, seed=seed)
    solution = interior(problem)
    np.testing.assert_allclose(solution, expected(problem), rtol=0, atol=1e-8)
    assert solution.min() >= low
    assert solution.max() <= high
    np.testing.assert_array_equal(solution == low, expected(problem) <= low + 1e-12)


def test_circles_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("nodegraph_blendshapes.solve.chain._ROUNDS", 1)
    assert chain().exchanged(np.full((7, 4), 0.25)) is None
