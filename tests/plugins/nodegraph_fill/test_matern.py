"""Gaussian processes over time beside their dense statements."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill import matern_kernel
from nodegraph_fill.gaussian_process import gaussian_process
from nodegraph_fill.matern import Courses, Matern
from tests.plugins.recordings import make_recording

Floats = NDArray[np.float64]


def covariance(frames: int, length: float) -> Floats:
    d = np.sqrt(5) * np.abs(np.subtract.outer(np.arange(frames), np.arange(frames))) / length
    return np.asarray((1 + d + d**2 / 3) * np.exp(-d))


def seen_in(frames: int) -> NDArray[np.bool_]:
    seen = np.ones(frames, dtype=np.bool_)
    seen[5:9] = seen[20] = seen[-2:] = False
    return seen


@pytest.mark.parametrize(("length", "noise"), [(2.0, 0.3), (9.0, 1e-3), (40.0, 1e-5)])
def test_errors_of_prediction_are_those_of_the_cholesky_factor(length: float, noise: float) -> None:
    rows, seen = np.random.default_rng(1).normal(size=(40, 3)), seen_in(40)
    dense = covariance(40, length)[np.ix_(seen, seen)] + noise * np.eye(seen.sum())
    factor = np.linalg.cholesky(dense)
    expected = np.linalg.solve(factor, rows[seen])
    total = matern_kernel.whiten(rows, seen, length, noise)
    np.testing.assert_allclose(rows[seen], expected, rtol=1e-4, atol=1e-4)
    assert not rows[~seen].any()
    assert total == pytest.approx(2 * np.log(np.diag(factor)).sum(), rel=1e-4)


def test_two_processes_in_two_channels_are_the_conditional_mean() -> None:
    frames, noises = 30, np.array([0.02, 0.05])
    lengths, variances = np.array([9.0, 3.0]), np.array([2.0, 0.5])
    covariances = [s * covariance(frames, n) for n, s in zip(lengths, variances, strict=True)]
    values = np.random.default_rng(2).normal(size=(frames, 2, 3))
    seen = np.stack([np.ones(frames, dtype=np.bool_), seen_in(frames)], axis=1)
    mean, variance = matern_kernel.smooth(lengths, variances, noises, values, seen, 3, 28)
    common, both = covariances[0], covariances[0] + covariances[1]
    shown = np.block([[common, common], [common, both]]) + np.diag(np.repeat(noises, frames))
    to = np.hstack([common, both])
    known = seen.T.ravel()
    gain = to[:, known] @ np.linalg.inv(shown[np.ix_(known, known)])
    every = values.transpose(1, 0, 2).reshape(-1, 3)[known]
    np.testing.assert_allclose(mean, (gain @ every)[3:28], atol=1e-9)
    left = np.diag(both - gain @ to[:, known].T)
    np.testing.assert_allclose(variance, left[3:28], atol=1e-9)


def test_length_noise_and_variance_are_found() -> None:
    random = np.random.default_rng(3)
    factor = np.linalg.cholesky(covariance(600, 12.0) + 1e-10 * np.eye(600))
    rows = 3.0 * factor @ random.normal(size=(600, 3)) + 0.2 * random.normal(size=(600, 3))
    found = Matern.fitted(rows, np.ones(600, dtype=np.bool_), 5.0, 1e-3)
    assert found.length == pytest.approx(12.0, rel=0.25)
    assert found.noise == pytest.approx(0.04, rel=0.2)
    assert found.variance == pytest.approx(9.0, rel=0.5)


def test_a_marker_follows_its_own_process() -> None:
    random = np.random.default_rng(4)
    factor = np.linalg.cholesky(covariance(80, 8.0) + 1e-3 * np.eye(80))
    positions = 50.0 + np.einsum("tu,umc->tmc", factor, random.normal(size=(80, 2, 3)))
    positions[30:36, 0] = positions[:3, 0] = np.nan
    recording = make_recording(positions)
    process = Courses.of(positions, recording.present).fitted(0)
    seen = recording.present[:, 0]
    middle = positions[seen, 0].mean(axis=0)
    dense = process.variance * covariance(80, process.length)
    inverse = np.linalg.inv((dense + process.noise * np.eye(80))[np.ix_(seen, seen)])
    expected = middle + dense[:, seen] @ inverse @ (positions[seen, 0] - middle)
    filled = gaussian_process(recording).positions[~seen, 0]
    np.testing.assert_allclose(filled, expected[~seen], atol=1e-6)
