"""Cosines above the cut-off are dropped, the others kept."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.dct import dct
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize("frames", [3, 10, 121])
@pytest.mark.parametrize("cutoff", [10.0, 12.0, 29.0])
def test_is_the_sum_of_its_slow_cosines(frames: int, cutoff: float) -> None:
    run = np.random.default_rng(frames).normal(0, 10, (frames, 1, 3))
    smoothed = dct(make_recording(run), cutoff=cutoff).positions[:, 0]
    number = np.arange(frames)
    cosines = np.cos(np.pi / frames * np.outer(number + 0.5, number)) * np.sqrt(2.0 / frames)
    cosines[:, 0] /= np.sqrt(2.0)
    slow = cosines[:, number * 60.0 / (2 * frames) <= cutoff + 1e-9]
    np.testing.assert_allclose(smoothed, slow @ (slow.T @ run[:, 0]), rtol=0, atol=1e-10)


def test_a_cosine_of_the_cut_off_itself_is_kept() -> None:
    wave = np.cos(np.pi * 40 * (np.arange(120) + 0.5) / 120)
    take = make_recording(np.repeat(wave[:, None, None], 3, 2))
    np.testing.assert_allclose(dct(take, cutoff=10.0).positions, take.positions, atol=1e-12)
    assert np.abs(dct(take, cutoff=9.99).positions).max() < 1e-12


def test_runs_of_which_only_the_mean_would_be_left_stay() -> None:
    run = np.random.default_rng(1).normal(0, 10, (9, 1, 3))
    run[2] = np.nan
    with pytest.warns(UserWarning, match="1 of 2 runs .* shorter than 3 frames"):
        smoothed = dct(make_recording(run), cutoff=10.0)
    np.testing.assert_array_equal(smoothed.positions[:2], run[:2])
    with pytest.raises(Refusal, match="needs 30 frames in a row"):
        dct(make_recording(run), cutoff=1.0)


def test_a_cut_off_above_half_the_rate_is_refused(noisy: Trajectories) -> None:
    with pytest.raises(Refusal, match="not below 30 Hz"):
        dct(noisy, cutoff=30.0)
