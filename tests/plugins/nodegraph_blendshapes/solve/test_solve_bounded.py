"""Least squares within bounds, beside SciPy and beside every choice of bound weights."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_blendshapes.solve import bounded, pivoting_kernel
from nodegraph_blendshapes.solve.bounded import are_least, inwards, least_squares, noise
from tests.plugins.kernels import run_as_python
from tests.plugins.nodegraph_blendshapes.solve.statements import (
    Matrix,
    by_scipy,
    least_norm,
    left,
    squares,
)

INF = float("inf")
BOUNDS = [(0.0, 1.0), (-0.5, 1.0), (-1.0, 0.0), (0.0, INF), (-INF, INF)]
FINITE = BOUNDS[:4]


def problem(
    seed: int, shapes: int, coordinates: int, *, targets: int = 4, noise: float = 0.5
) -> tuple[Matrix, Matrix]:
    """Columns, and targets that weights beyond the bounds too would explain but for noise."""
    random = np.random.default_rng(seed)
    columns = random.normal(0, 3, (shapes, coordinates))
    weights = random.uniform(-0.7, 1.7, (targets, shapes))
    return columns, weights @ columns + random.normal(0, noise, (targets, coordinates))


def near(columns: Matrix, apart: float, seed: int = 0) -> Matrix:
    """The columns, and two more that lie so near to the first two."""
    random = np.random.default_rng(seed)
    return np.vstack([columns, columns[:2] + apart * random.normal(size=columns[:2].shape)])


@pytest.mark.parametrize(("low", "high"), BOUNDS)
@given(seed=st.integers(0, 10**6), shapes=st.integers(1, 12), more=st.integers(0, 20))
def test_as_scipy(low: float, high: float, seed: int, shapes: int, more: int) -> None:
    columns, targets = problem(seed, shapes, shapes + more)
    solution = least_squares(columns, targets, low, high)
    assert not solution.unsolved.any()
    assert left(columns, targets, solution.weights, low, high) <= 1e-10
    assert solution.weights.min() >= low
    assert solution.weights.max() <= high
    theirs = by_scipy(columns, targets, low, high)
    if np.linalg.cond(columns) < 1e4:
        np.testing.assert_allclose(solution.weights, theirs, rtol=0, atol=1e-7)
    for target, ours, other in zip(targets, solution.weights, theirs, strict=True):
        assert (
            squares(columns, target, ours) <= squares(columns, target, other) * (1 + 1e-10) + 1e-20
        )


@pytest.mark.parametrize(("low", "high"), FINITE)
@pytest.mark.parametrize("apart", [1e-2, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12, 0.0])
def test_columns_that_hardly_differ(low: float, high: float, apart: float) -> None:
    columns, targets = problem(3, 8, 20, targets=30)
    columns = near(columns, apart)
    solution = least_squares(columns, targets, low, high)
    assert not solution.unsolved.any()
    assert left(columns, targets, solution.weights, low, high) <= 1e-10
    theirs = by_scipy(columns, targets, low, high)
    for target, ours, other in zip(targets, solution.weights, theirs, strict=True):
        assert (
            squares(columns, target, ours) <= squares(columns, target, other) * (1 + 1e-9) + 1e-20
        )


@pytest.mark.parametrize(("low", "high"), BOUNDS)
@given(seed=st.integers(0, 10**6), shapes=st.integers(2, 5), noise=st.sampled_from([0.0, 0.5]))
def test_ties_have_the_least_norm(
    low: float, high: float, seed: int, shapes: int, noise: float
) -> None:
    columns, targets = problem(seed, shapes, max(1, shapes - 2), targets=3, noise=noise)
    solution = least_squares(columns, targets, low, high)
    assert not solution.unsolved.any()
    assert left(columns, targets, solution.weights, low, high) <= 1e-10
    for target, ours in zip(targets, solution.weights, strict=True):
        shortest = least_norm(columns, ours, low, high)
        assert ours @ ours <= (shortest @ shortest) * (1 + 1e-7) + 1e-9
        assert squares(columns, target, ours) <= squares(columns, target, shortest) + 1e-7


@pytest.mark.parametrize(("low", "high"), BOUNDS)
def test_a_face_at_rest_has_no_weights(low: float, high: float) -> None:
    columns, targets = problem(0, 9, 4)
    targets[1:3] = 0.0
    solution = least_squares(columns, targets, low, high)
    np.testing.assert_array_equal(solution.weights[1:3], 0.0)
    columns, targets = problem(0, 4, 9)
    targets[1:3] = 0.0
    np.testing.assert_allclose(least_squares(columns, targets, low, high).weights[1:3], 0.0)


def test_no_columns_and_no_targets() -> None:
    assert least_squares(np.zeros((0, 4)), np.ones((3, 4)), 0.0, 1.0).weights.shape == (3, 0)
    columns, targets = problem(0, 4, 9, targets=0)
    for low, high in BOUNDS:
        assert least_squares(columns, targets, low, high).weights.shape == (0, 4)
        assert least_squares(near(columns, 0.0), targets, low, high).weights.shape == (0, 6)


@pytest.mark.parametrize("apart", [1.0, 0.0])
@pytest.mark.parametrize(("low", "high"), FINITE)
def test_targets_do_not_know_of_each_other(low: float, high: float, apart: float) -> None:
    columns, targets = problem(4, 12, 30, targets=40)
    columns = near(columns, apart)
    together = least_squares(columns, targets, low, high).weights
    backwards = least_squares(columns, targets[::-1], low, high).weights[::-1]
    alone = [least_squares(columns, target[None], low, high).weights[0] for target in targets]
    np.testing.assert_allclose(together, backwards, rtol=0, atol=1e-11)
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-11)


def test_the_conditions_by_hand() -> None:
    columns, targets = np.array([[2.0, 0.0], [0.0, 3.0]]), np.array([[5.0, -6.0]])
    weights = np.array([[1.0, 0.0]])
    # the gradient is 2 (2 - 5) = -6 at the upper bound, 3 (0 + 6) = 18 at the lower: both push out
    np.testing.assert_array_equal(inwards(columns, targets, weights, 0.0, 1.0), [[0.0, 0.0]])
    np.testing.assert_array_equal(inwards(columns, targets, weights, 0.0, 2.0), [[-6.0, 0.0]])
    np.testing.assert_array_equal(inwards(columns, targets, weights, -1.0, 1.0), [[0.0, 18.0]])
    size = np.hypot(5.0, 6.0) + 2.0
    np.testing.assert_allclose(noise(columns, targets, weights), [[2 * size, 3 * size]])
    assert are_least(columns, targets, weights, 0.0, 1.0).all()
    assert not are_least(columns, targets, weights, 0.0, 2.0).any()


@pytest.mark.parametrize(("low", "high"), FINITE)
def test_what_hardly_shows_is_found(low: float, high: float) -> None:
    """Directions a ten-thousandth as large as others, which the ridge lets in slowly."""
    random = np.random.default_rng(0)
    columns = random.normal(0, 3, (12, 9)) * np.logspace(0, -4, 9)
    columns = (
        np.logspace(0, -2, 12)[:, None] * columns @ np.linalg.qr(random.normal(size=(9, 9)))[0]
    )
    targets = np.clip(random.uniform(-0.7, 1.7, (40, 12)), low, high) @ columns
    solution = least_squares(columns, targets, low, high)
    assert not solution.unsolved.any()
    assert are_least(columns, targets, solution.weights, low, high).all()


def test_what_nothing_finds_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    columns, targets = problem(5, 12, 30, targets=20)
    targets[0] = 0.0
    monkeypatch.setattr(bounded, "_ROUNDS", 1)
    solution = least_squares(columns, targets, 0.0, 1.0)
    assert np.count_nonzero(solution.unsolved) > 10
    np.testing.assert_array_equal(np.isnan(solution.weights).all(axis=1), solution.unsolved)
    np.testing.assert_array_equal(solution.weights[0], 0.0)


def test_exchanging_one_at_a_time_ends_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Murty's rule alone, as when exchanging many at a time goes round in circles."""
    run_as_python(monkeypatch, pivoting_kernel)
    monkeypatch.setattr(pivoting_kernel, "_ROUNDS", -1)
    columns, targets = problem(8, 6, 10, targets=10)
    solution = least_squares(columns, targets, 0.0, 1.0)
    expected = by_scipy(columns, targets, 0.0, 1.0)
    np.testing.assert_allclose(solution.weights, expected, rtol=0, atol=1e-10)
