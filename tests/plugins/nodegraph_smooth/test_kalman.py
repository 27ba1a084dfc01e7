"""The mean and the spread of the state, all samples being known."""

from __future__ import annotations

from dataclasses import replace
from math import factorial

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import make_smoothing_spline

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.kalman import Motion, kalman
from tests.plugins.recordings import make_recording


def density(cutoff: float, rate: float, order: int) -> float:
    """1 / S at the cut-off, S summed over the frequencies that frames cannot tell apart."""
    width = 2 * np.pi * cutoff / rate
    return float(1 / np.sum((width + 2 * np.pi * np.arange(-4000, 4001.0)) ** (-2.0 * order)))


def posterior(
    run: NDArray[np.float64], order: int, ratio: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and variance of the positions, from all states at once; measurements of variance 1."""
    length = len(run)
    step, noise = np.zeros((order, order)), np.zeros((order, order))
    for i in range(order):
        for j in range(order):
            if j >= i:
                step[i, j] = 1 / factorial(j - i)
            up, across = order - 1 - i, order - 1 - j
            noise[i, j] = ratio / (factorial(up) * factorial(across) * (up + across + 1))
    information = np.zeros((length * order, length * order))
    for t in range(length):
        information[t * order, t * order] += 1
    for t in range(length - 1):
        link = np.zeros((order, length * order))
        link[:, t * order : (t + 1) * order] = -step
        link[:, (t + 1) * order : (t + 2) * order] = np.eye(order)
        information += link.T @ np.linalg.solve(noise, link)
    covariance = np.linalg.inv(information)[::order, ::order]
    return covariance @ run, np.diag(covariance)


@pytest.mark.parametrize(("motion", "order"), [("velocity", 2), ("acceleration", 3)])
@pytest.mark.parametrize("length", [3, 4, 30])
def test_mean_and_sigma_are_those_of_all_states_at_once(
    motion: Motion, order: int, length: int
) -> None:
    run = np.random.default_rng(length).normal(0, 10, (length, 1, 3))
    smoothed = kalman(make_recording(run), cutoff=8.0, motion=motion, noise=0.3)
    mean, variance = posterior(run[:, 0], order, density(8.0, 60.0, order))
    np.testing.assert_allclose(smoothed.positions[:, 0], mean, rtol=0, atol=1e-7)
    assert smoothed.sigma is not None
    np.testing.assert_allclose(smoothed.sigma[:, 0], 0.3 * np.sqrt(variance), rtol=1e-7)


def test_constant_velocity_is_the_cubic_smoothing_spline(noisy: Trajectories) -> None:
    smoothed = kalman(noisy, cutoff=5.0).positions
    frame = np.arange(121.0)
    spline = make_smoothing_spline(frame, noisy.positions, lam=1 / density(5.0, 60.0, 2))
    np.testing.assert_allclose(smoothed, spline(frame), rtol=0, atol=1e-7)


@pytest.mark.parametrize("motion", ["velocity", "acceleration"])
def test_half_of_the_amplitude_is_kept_at_the_cut_off(motion: Motion) -> None:
    for cutoff in (2.0, 10.0, 24.0):
        wave = np.cos(2 * np.pi * cutoff / 60.0 * np.arange(-600, 601))
        take = make_recording(np.repeat(wave[:, None, None], 3, 2))
        smoothed = kalman(take, cutoff=cutoff, motion=motion).positions[300:900, 0, 0]
        np.testing.assert_allclose(smoothed, wave[300:900] / 2, rtol=0, atol=1e-5)


def test_sigma_is_the_spread_of_what_the_model_makes() -> None:
    random = np.random.default_rng(2)
    ratio, noise, markers = density(10.0, 60.0, 2), 0.5, 400
    factor = np.linalg.cholesky(noise**2 * ratio * np.array([[1 / 3, 1 / 2], [1 / 2, 1]]))
    state, truth = np.zeros((2, markers * 3)), np.empty((40, markers * 3))
    for t in range(40):
        truth[t] = state[0]
        state = np.array([[1, 1], [0, 1]]) @ state + factor @ random.normal(0, 1, state.shape)
    samples = truth + random.normal(0, noise, truth.shape)
    smoothed = kalman(make_recording(samples.reshape(40, markers, 3)), noise=noise)
    spread = (smoothed.positions.reshape(40, -1) - truth).std(axis=1)
    assert smoothed.sigma is not None
    np.testing.assert_allclose(smoothed.sigma[:, 0], spread, rtol=0.1)


def test_sigma_of_what_is_left_as_it_was() -> None:
    positions = np.random.default_rng(1).normal(0, 1, (9, 2, 3))
    positions[1, 0] = np.nan
    recording = make_recording(positions)
    with pytest.warns(UserWarning, match="1 of 3 runs .* shorter than 2 frames"):
        smoothed = kalman(recording, noise=0.2)
    assert smoothed.sigma is not None
    assert smoothed.sigma[0, 0] == 0.2
    assert np.isnan(smoothed.sigma[1, 0])
    assert (np.delete(smoothed.sigma, [0, 1], axis=0) < 0.2).all()
    known = replace(recording, sigma=np.where(recording.present, 0.7, np.nan))
    with pytest.warns(UserWarning, match="1 of 3 runs"):
        again = kalman(known, noise=0.2)
    assert again.sigma is not None
    assert again.sigma[0, 0] == 0.7


def test_positions_do_not_depend_on_the_noise(noisy: Trajectories) -> None:
    first, second = kalman(noisy, noise=0.1), kalman(noisy, noise=40.0)
    np.testing.assert_array_equal(first.positions, second.positions)


def test_bad_settings(noisy: Trajectories) -> None:
    with pytest.raises(ValueError, match="motion must be velocity or acceleration, got 'jerk'"):
        kalman(noisy, motion="jerk")
    with pytest.raises(ValueError, match="noise must be a positive number of mm, got 0"):
        kalman(noisy, noise=0.0)
    with pytest.raises(Refusal, match="not below 30 Hz"):
        kalman(noisy, cutoff=30.0)
    with pytest.raises(Refusal, match="too low at 60 Hz"):
        kalman(noisy, cutoff=0.01)
