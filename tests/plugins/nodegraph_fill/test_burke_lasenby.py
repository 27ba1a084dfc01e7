"""A Kalman smoother in the subspace of the complete frames."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_fill.burke_lasenby import burke_lasenby
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]
MISSING = ((slice(4, 8), 0), (slice(6, 10), 2), (slice(0, 2), 3), (slice(12, 14), 1))


def take() -> Positions:
    """Markers that two hidden movements drive, and noise."""
    random = np.random.default_rng(1)
    hidden = np.cumsum(random.normal(0, 1, (30, 2)), axis=0)
    shapes = random.normal(0, 1, (2, 4, 3))
    noise = random.normal(0, 0.2, (30, 4, 3))
    return np.asarray(
        random.normal(0, 30, (4, 3)) + np.einsum("tk,kmc->tmc", hidden, shapes) + noise
    )


def holed() -> Positions:
    positions = take()
    for where in MISSING:
        positions[where] = np.nan
    return positions


def plain(gappy: Positions, tolerance: float, noise: float, known: NDArray[np.bool_]) -> Positions:
    """The mean of every sample by one normal distribution of all samples of all frames."""
    rows = gappy.reshape(len(gappy), -1)
    complete = rows[~np.isnan(rows).any(axis=1)]
    middle = complete.mean(axis=0)
    _, values, components = np.linalg.svd(complete - middle)
    size = int(np.flatnonzero(np.cumsum(values) / values.sum() > 1 - tolerance)[0])
    basis = components[:size]
    steps = basis @ np.diag(np.diff(complete, axis=0).std(axis=0)) @ basis.T
    frames = np.arange(len(rows))
    walk = 1e7 * noise * np.kron(np.ones((len(rows), len(rows))), np.eye(size))
    walk += np.kron(np.minimum.outer(frames, frames), steps)
    spread = np.kron(np.eye(len(rows)), basis.T)
    covariance = spread @ walk @ spread.T + noise * np.eye(rows.size)
    k = known.ravel()
    off = (rows - middle).ravel()[k]
    mean = covariance[:, k] @ np.linalg.solve(covariance[np.ix_(k, k)], off)
    return np.asarray(mean.reshape(gappy.shape) + middle.reshape(-1, 3))


@pytest.mark.parametrize(("tolerance", "noise"), [(0.2, 0.5), (0.05, 0.01)])
def test_is_the_conditional_mean(tolerance: float, noise: float) -> None:
    gappy = holed()
    filled = burke_lasenby(make_recording(gappy), tolerance=tolerance, noise=noise)
    hidden = np.isnan(gappy[..., 0])
    expected = plain(gappy, tolerance, noise, ~np.isnan(gappy))
    np.testing.assert_allclose(filled.positions[hidden], expected[hidden], rtol=0, atol=1e-4)
    assert filled.sigma is None


def test_the_ends_are_estimated_without_what_the_gap_lacks() -> None:
    gappy = holed()
    free, met = (
        burke_lasenby(make_recording(gappy), tolerance=0.2, noise=0.5, ends=ends).positions[4:8, 0]
        for ends in ("as_published", "met")
    )
    before, after = ~np.isnan(gappy), ~np.isnan(gappy)
    before[3, 0] = after[8, [0, 2]] = False
    first = gappy[3, 0] - plain(gappy, 0.2, 0.5, before)[3, 0]
    last = gappy[8, 0] - plain(gappy, 0.2, 0.5, after)[8, 0]
    share = np.arange(1, 5)[:, None] / 5
    np.testing.assert_allclose(met, free + (1 - share) * first + share * last, atol=1e-4)


def test_complete_frames_are_needed() -> None:
    gappy = take()
    gappy[::2, 0] = gappy[1::2, 1] = np.nan
    with pytest.raises(Refusal, match="needs two complete frames: 0 of 30"):
        burke_lasenby(make_recording(gappy))
