"""The smoothing spline that cross-validation chooses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import make_smoothing_spline

from nodegraph_mocap import Trajectories
from nodegraph_smooth import gcv_kernel
from nodegraph_smooth.gcv import gcv
from tests.plugins.recordings import make_recording


def test_equals_scipys_spline_with_the_lambda_that_was_chosen(noisy: Trajectories) -> None:
    smoothed = gcv(noisy).positions
    _, chosen = gcv_kernel.smooth(noisy.positions - noisy.positions[0])
    frame = np.arange(121.0)
    for marker, penalty in enumerate(chosen):
        spline = make_smoothing_spline(frame, noisy.positions[:, marker], lam=penalty)
        np.testing.assert_allclose(smoothed[:, marker], spline(frame), rtol=0, atol=1e-8)


def wave(noise: float) -> NDArray[np.float64]:
    """One coordinate that swings, with noise, beside two that stand still: (150, 1, 3)."""
    positions = np.zeros((150, 1, 3))
    positions[:, 0, 1] = 10.0 * np.sin(np.arange(150) / 12.0)
    positions[:, 0, 1] += np.random.default_rng(3).normal(0, noise, 150)
    return positions


@pytest.mark.parametrize("noise", [0.01, 0.1, 0.3])
def test_chooses_as_scipy_does_for_one_coordinate(noise: float) -> None:
    positions = wave(noise)
    smoothed = gcv(make_recording(positions)).positions[:, 0, 1]
    frame = np.arange(150.0)
    expected = make_smoothing_spline(frame, positions[:, 0, 1])(frame)
    np.testing.assert_allclose(smoothed, expected, rtol=0, atol=1e-6)


def test_finds_a_lambda_larger_than_the_number_of_frames() -> None:
    _, chosen = gcv_kernel.smooth(wave(1.0))
    smoothed = np.empty((150, 3))
    values = [
        gcv_kernel.criterion(wave(1.0)[:, 0], value, smoothed) for value in (chosen[0], 150.0)
    ]
    assert chosen[0] > 160.0
    assert values[0] < values[1]


def test_coordinates_share_one_lambda_so_that_axes_do_not_matter(noisy: Trajectories) -> None:
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    turned = gcv(replace(noisy, positions=noisy.positions @ turn.T)).positions @ turn
    np.testing.assert_allclose(turned, gcv(noisy).positions, rtol=0, atol=1e-6)


def test_smooths_as_much_as_there_is_noise(noisy: Trajectories) -> None:
    clean = gcv(noisy)
    more = replace(
        clean,
        positions=clean.positions + np.random.default_rng(8).normal(0, 1, clean.positions.shape),
    )
    before, after = (more.positions - clean.positions), gcv(more).positions - clean.positions
    assert np.sqrt(np.mean(after**2)) < 0.5 * np.sqrt(np.mean(before**2))


@pytest.mark.parametrize("frames", [5, 6, 40])
def test_straight_lines_stay(frames: int) -> None:
    line = np.arange(float(frames))[:, None, None] * [[1.0, -2.0, 0.5]] + 300.0
    np.testing.assert_allclose(gcv(make_recording(line)).positions, line, rtol=0, atol=1e-9)
