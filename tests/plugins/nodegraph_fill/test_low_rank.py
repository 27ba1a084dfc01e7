"""The take completed to a matrix of small nuclear norm."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill import low_rank
from nodegraph_fill.low_rank import LowRank
from nodegraph_fill.whole_take import TakeMatrix

Rows = NDArray[np.float64]


def matrix(seed: int, share: float = 0.2, noise: float = 0.05) -> TakeMatrix:
    frames, width = 40, 12
    random = np.random.default_rng(seed)
    rows = random.normal(size=(frames, 3)) @ random.normal(size=(3, width))
    rows += noise * random.normal(size=rows.shape)
    missing = random.random(rows.shape) < share
    missing[5] = missing[6] = True
    return TakeMatrix(
        np.where(missing, 0.0, rows), missing, np.zeros(width), np.ones(width // 3, np.bool_)
    )


def test_rows_are_completed_to_the_least_of_the_quadratic_form() -> None:
    problem, random = matrix(2), np.random.default_rng(2)
    low_rank = LowRank(problem, 0.02)
    rows = random.normal(size=(20, 12))
    missing = random.random(rows.shape) < 0.4
    missing[3] = True
    missing[4] = False
    missing[11] = missing[10]
    completed = low_rank.completed(rows, missing)
    np.testing.assert_array_equal(completed[~missing], rows[~missing])
    np.testing.assert_allclose((completed @ low_rank.precision)[missing], 0.0, atol=1e-9)


@pytest.mark.parametrize("shrinkage", [0.3, 0.02, 0.001])
@pytest.mark.parametrize(("share", "noise"), [(0.05, 0.05), (0.4, 0.05), (0.2, 0.0)])
def test_the_gradient_at_what_is_missing_vanishes(
    shrinkage: float, share: float, noise: float
) -> None:
    problem = matrix(4, share, noise)
    rows = LowRank(problem, shrinkage).rows
    _, values, v = np.linalg.svd(rows, full_matrices=False)
    threshold = shrinkage * np.linalg.norm(problem.rows, 2)
    gradient = rows @ (v.T * threshold / np.maximum(values, threshold)) @ v
    np.testing.assert_allclose(gradient[problem.missing], 0.0, atol=1e-10)


def test_what_begins_from_another_is_nearly_the_solution() -> None:
    problem, other = matrix(5), matrix(6)
    exact = LowRank(problem, 0.01).rows
    size = np.sqrt(np.mean(problem.rows[~problem.missing] ** 2))
    begun = LowRank(problem, 0.01, near=LowRank(other, 0.01), settled=1e-3).rows
    np.testing.assert_allclose(begun, exact, rtol=0, atol=5e-3 * size)


@pytest.mark.parametrize("shrinkage", [0.3, 0.02, 0.001])
def test_no_other_completion_has_a_smaller_sum(shrinkage: float) -> None:
    problem = matrix(3)
    threshold = shrinkage * np.linalg.norm(problem.rows, 2)

    def total(rows: Rows) -> float:
        values = np.linalg.svd(rows, compute_uv=False)
        small = values**2 / 2
        return float(
            np.where(values < threshold, small, threshold * (values - threshold / 2)).sum()
        )

    actual = LowRank(problem, shrinkage)
    np.testing.assert_array_equal(actual.rows[~problem.missing], problem.rows[~problem.missing])
    random = np.random.default_rng(4)
    for size in (1e-3, 0.1, 3.0):
        for _ in range(20):
            other = actual.rows + size * problem.missing * random.normal(size=actual.rows.shape)
            assert total(other) > total(actual.rows)


def test_what_never_moves_stays() -> None:
    problem = matrix(5)
    still = TakeMatrix(np.zeros_like(problem.rows), problem.missing, problem.middle, problem.seen)
    np.testing.assert_array_equal(LowRank(still, 0.01).rows, 0.0)


def test_ending_early_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(low_rank, "_MOST_ROUNDS", 2)
    with pytest.warns(UserWarning, match="has not settled after 2 rounds: the last one still "):
        LowRank(matrix(6), 0.001)
