"""A Kalman smoother in the few dimensions in which the markers move."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodegraph_fill.soft_impute import soft_impute
from nodegraph_fill.subspace_kalman import subspace_kalman
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_fill.plain_fills import driven
from tests.plugins.recordings import make_recording

Positions = NDArray[np.float64]
take = partial(driven, movements=2, noise=0.2, seed=1)


class Plain:
    """The same model as one normal distribution of all samples of all frames."""

    def __init__(self, gappy: Positions, recording: Trajectories, variance: float) -> None:
        frames = len(gappy)
        full = soft_impute(recording, ends="as_published").positions.reshape(frames, -1)
        self.middle = full.mean(axis=0)
        u, values, v = np.linalg.svd(full - self.middle, full_matrices=False)
        shares = np.cumsum(values**2) / (values**2).sum()
        size = int(np.flatnonzero(shares >= variance)[0]) + 1
        states = u[:, :size] * values[:size]
        basis = v[:size].T
        known = ~np.isnan(gappy).reshape(frames, -1)
        left = full - self.middle - states @ basis.T
        noise = np.array([(left[k, i] ** 2).mean() for i, k in enumerate(known.T)])
        steps = np.diff(states, axis=0)
        # the walk's covariance at two frames is what has gathered up to the earlier one
        first = np.diag((states**2).mean(axis=0))
        earlier = np.minimum.outer(np.arange(frames), np.arange(frames))
        walk = np.kron(np.ones_like(earlier), first)
        walk += np.kron(earlier, steps.T @ steps / (frames - 1))
        spread = np.kron(np.eye(frames), basis)
        self.covariance = spread @ walk @ spread.T + np.diag(np.tile(noise, frames))
        self.known = known
        self.rows = gappy.reshape(frames, -1)

    def __call__(self, known: Any) -> tuple[Positions, Positions]:
        """Return mean and variance of every sample, those that are known being given."""
        k = known.ravel()
        middle = np.tile(self.middle, len(known))
        gain = self.covariance[:, k] @ np.linalg.inv(self.covariance[np.ix_(k, k)])
        mean = middle + gain @ (self.rows.ravel()[k] - middle[k])
        variance = np.diag(self.covariance - gain @ self.covariance[k])
        shape = (len(known), -1, 3)
        return mean.reshape(shape), variance.reshape(shape)


def holed() -> Positions:
    positions = take(14, 4)
    positions[4:8, 0] = positions[6:10, 2] = positions[:2, 3] = positions[12:, 1] = np.nan
    positions[11] = np.nan
    return positions


def test_is_the_conditional_mean() -> None:
    gappy = holed()
    recording = make_recording(gappy)
    filled = subspace_kalman(recording, variance=0.9, ends="as_published")
    plain = Plain(gappy, recording, 0.9)
    mean, _ = plain(plain.known)
    missing = ~recording.present
    np.testing.assert_allclose(filled.positions[missing], mean[missing], rtol=0, atol=1e-5)


def test_sigma_is_in_proportion_to_the_conditional_variance() -> None:
    gappy = take(30, 12)
    for marker in range(12):
        gappy[2 + marker : 4 + marker, marker] = np.nan
    recording = make_recording(gappy)
    missing = ~recording.present
    sigma = subspace_kalman(recording, variance=0.9).sigma
    plain = Plain(gappy, recording, 0.9)
    _, variance = plain(plain.known)
    assert sigma is not None
    scale = sigma[missing] / np.sqrt(variance[missing].mean(axis=1))
    np.testing.assert_allclose(scale, scale[0], rtol=1e-5)
    assert np.isnan(sigma[recording.present]).all()


def test_the_ends_are_estimated_without_what_the_gap_lacks() -> None:
    gappy = take(14, 4)
    gappy[4:8, 0] = gappy[6:10, 2] = np.nan
    recording = make_recording(gappy)
    free = subspace_kalman(recording, variance=0.9).positions
    bent = subspace_kalman(recording, variance=0.9, ends="met").positions
    plain = Plain(gappy, recording, 0.9)

    def mismatch(frame: int, *lacking: int) -> Positions:
        known = plain.known.copy().reshape(14, 4, 3)
        known[frame, list(lacking)] = False
        return np.asarray(gappy[frame, 0] - plain(known.reshape(14, -1))[0][frame, 0])

    share = np.arange(1, 5)[:, None] / 5
    expected = free[4:8, 0] + (1 - share) * mismatch(3, 0) + share * mismatch(8, 0, 2)
    np.testing.assert_allclose(bent[4:8, 0], expected, rtol=0, atol=1e-5)


def test_sigma_grows_into_a_gap_of_all_markers() -> None:
    gappy = take(60, 12)
    gappy[10:21] = np.nan
    sigma = subspace_kalman(make_recording(gappy)).sigma
    assert sigma is not None
    assert np.all(np.diff(sigma[10:16], axis=0) > 0)
    assert np.all(np.diff(sigma[15:21], axis=0) < 0)


def test_what_never_moves_stays() -> None:
    positions = np.broadcast_to(np.random.default_rng(1).normal(size=(3, 3)), (9, 3, 3)).copy()
    gappy = positions.copy()
    gappy[2:5, 0] = np.nan
    filled = subspace_kalman(make_recording(gappy))
    np.testing.assert_allclose(filled.positions, positions, rtol=0, atol=1e-12)
