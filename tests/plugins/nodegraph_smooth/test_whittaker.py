"""Least squares with a penalty on differences."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.whittaker import whittaker
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("length", [4, 5, 9, 60])
def test_minimizes_its_sum_of_squares(order: int, length: int) -> None:
    run = np.random.default_rng(length).normal(0, 10, (length, 1, 3))
    smoothed = whittaker(make_recording(run), cutoff=6.0, order=order).positions[:, 0]
    penalty = (2 * np.sin(np.pi * 6.0 / 60.0)) ** (-2 * order)
    differences = np.diff(np.eye(length), n=order, axis=0)
    expected = np.linalg.solve(np.eye(length) + penalty * differences.T @ differences, run[:, 0])
    np.testing.assert_allclose(smoothed, expected, rtol=0, atol=1e-10)


def test_penalty_is_one_with_the_defaults_at_60_hz(noisy: Trajectories) -> None:
    smoothed = whittaker(noisy).positions
    differences = np.diff(np.eye(noisy.frames), n=2, axis=0)
    matrix = np.eye(noisy.frames) + differences.T @ differences
    expected = np.linalg.solve(matrix, noisy.positions.reshape(noisy.frames, -1))
    np.testing.assert_allclose(smoothed.reshape(noisy.frames, -1), expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_half_of_the_amplitude_is_kept_at_the_cut_off(order: int) -> None:
    wave = np.cos(2 * np.pi * 7.0 / 60.0 * np.arange(-600, 601))
    smoothed = whittaker(
        make_recording(np.repeat(wave[:, None, None], 3, 2)), cutoff=7.0, order=order
    )
    middle = slice(300, 900)
    np.testing.assert_allclose(
        smoothed.positions[middle, 0, 0], wave[middle] / 2, rtol=0, atol=1e-6
    )


def test_cut_offs_that_cannot_be_are_refused(noisy: Trajectories) -> None:
    with pytest.raises(Refusal, match="not below 30 Hz"):
        whittaker(noisy, cutoff=40.0)
    with pytest.raises(Refusal, match="too low at 60 Hz"):
        whittaker(noisy, cutoff=0.01, order=3)
