"""The take completed to a matrix of small nuclear norm."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill import low_rank
from nodegraph_fill.low_rank import LowRank
from nodegraph_fill.low_rank_kernel import complete
from nodegraph_fill.whole_take import TakeMatrix

Rows = NDArray[np.float64]


def matrix(seed: int, frames: int = 40, width: int = 12, share: float = 0.2) -> TakeMatrix:
    random = np.random.default_rng(seed)
    rows = random.normal(size=(frames, 3)) @ random.normal(size=(3, width))
    rows += 0.05 * random.normal(size=rows.shape)
    missing = random.random(rows.shape) < share
    missing[5] = missing[6] = True
    return TakeMatrix(
        np.where(missing, 0.0, rows), missing, np.zeros(width), np.ones(width // 3, np.bool_)
    )


def test_rows_are_completed_to_the_least_of_the_quadratic_form() -> None:
    random = np.random.default_rng(2)
    factor = random.normal(size=(9, 9))
    precision = factor @ factor.T + 0.1 * np.eye(9)
    rows = random.normal(size=(20, 9))
    missing = random.random(rows.shape) < 0.4
    missing[3] = True
    missing[4] = False
    missing[11] = missing[10]
    completed = rows.copy()
    complete(completed, missing, precision)
    np.testing.assert_array_equal(completed[~missing], rows[~missing])
    np.testing.assert_allclose((completed @ precision)[missing], 0.0, atol=1e-9)


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
