"""The take completed to a matrix of small nuclear norm."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill import low_rank
from nodegraph_fill.bilinear import bilinear
from nodegraph_fill.low_rank import LowRank
from nodegraph_fill.soft_impute import soft_impute
from nodegraph_fill.subspace_kalman import subspace_kalman
from nodegraph_fill.whole_take import TakeMatrix
from tests.plugins.recordings import make_recording

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


def test_ending_early_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(low_rank, "_MOST_ROUNDS", 2)
    rows = np.where(matrix(6).missing, np.nan, matrix(6).rows).reshape(40, -1, 3)
    rows[np.isnan(rows).any(axis=2)] = np.nan
    recording = make_recording(rows)
    for fill in (soft_impute, bilinear, subspace_kalman):
        for ends in ("as_published", "met"):
            with pytest.warns(UserWarning, match="not settled after 2 rounds: the last one still "):
                fill(recording, ends=ends)
