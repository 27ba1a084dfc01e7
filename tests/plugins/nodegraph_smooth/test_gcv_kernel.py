"""The compiled loops do what their docstrings say."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_smooth import gcv_kernel


def hat(length: int, penalty: float) -> NDArray[np.float64]:
    """The matrix that takes samples to the spline at the frames, by Reinsch's equations."""
    bend = np.diff(np.eye(length), n=2, axis=0)
    beside = np.full(length - 3, 1 / 6)
    inner = np.diag(np.full(length - 2, 2 / 3)) + np.diag(beside, 1) + np.diag(beside, -1)
    inner_bend = np.linalg.solve(inner, bend)
    return np.asarray(np.linalg.inv(np.eye(length) + penalty * bend.T @ inner_bend))


@pytest.mark.parametrize("length", [5, 6, 7, 50])
@pytest.mark.parametrize("penalty", [1e-4, 0.3, 20.0, 1e4])
def test_spline_residuals_freedom_and_criterion(length: int, penalty: float) -> None:
    values = np.random.default_rng(length).normal(0, 10, (length, 3))
    smoothed = np.empty_like(values)
    residuals = gcv_kernel.spline(values, penalty, smoothed)
    matrix = hat(length, penalty)
    np.testing.assert_allclose(smoothed, matrix @ values, rtol=0, atol=1e-10)
    assert residuals == pytest.approx(np.sum((values - matrix @ values) ** 2), rel=1e-9)
    freedom = gcv_kernel.freedom(length, penalty)
    assert freedom == pytest.approx(np.trace(np.eye(length) - matrix), rel=1e-9)
    value = gcv_kernel.criterion(values, penalty, smoothed)
    assert value == pytest.approx(length * residuals / freedom**2, rel=1e-12)


def test_no_lambda_on_a_fine_grid_is_better() -> None:
    random = np.random.default_rng(4)
    walk = np.cumsum(random.normal(0, 0.3, (80, 2, 3)), axis=0)
    values = walk + random.normal(0, 1.0, (80, 2, 3))
    _, chosen = gcv_kernel.smooth(values)
    for run, penalty in enumerate(chosen):
        first, smoothed = values[:, run].copy(), np.empty((80, 3))
        best = gcv_kernel.criterion(first, penalty, smoothed)
        others = [
            gcv_kernel.criterion(first, other, smoothed) for other in np.geomspace(1e-4, 4e7, 700)
        ]
        assert best <= min(others) * (1 + 1e-9)


def test_a_still_run_stays_still() -> None:
    smoothed, chosen = gcv_kernel.smooth(np.zeros((9, 1, 3)))
    assert not smoothed.any()
    assert np.isfinite(chosen).all()
