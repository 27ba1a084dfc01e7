"""The polynomial of each window, by least squares."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.savgol import savgol
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize(("window", "degree", "frames"), [(0.15, 3, 9), (0.2, 2, 13), (0.1, 0, 7)])
def test_each_sample_is_that_of_its_windows_polynomial(
    noisy: Trajectories, window: float, degree: int, frames: int
) -> None:
    smoothed = savgol(noisy, window=window, degree=degree).positions
    reach = frames // 2
    for frame in range(noisy.frames):
        middle = min(max(frame, reach), noisy.frames - 1 - reach)
        place = np.arange(middle - reach, middle + reach + 1)
        for marker in range(3):
            run = noisy.positions[place, marker]
            fitted = np.polynomial.polynomial.polyfit(place - frame, run, degree)
            np.testing.assert_allclose(smoothed[frame, marker], fitted[0], rtol=0, atol=1e-9)


def test_share_of_noise_kept_with_the_defaults() -> None:
    impulse = np.zeros((41, 1, 3))
    impulse[20] = 1.0
    smoothed = savgol(make_recording(impulse)).positions[:, 0, 0]
    assert np.sum(smoothed**2) == pytest.approx(0.255, abs=5e-4)
    assert np.flatnonzero(np.abs(smoothed) > 1e-12).tolist() == list(range(16, 25))


def test_a_reach_in_frames_takes_the_place_of_the_window(noisy: Trajectories) -> None:
    assert np.array_equal(savgol(noisy, reach=4).positions, savgol(noisy).positions)
    with pytest.raises(Refusal, match="a window of reach 1 is 3 frames"):
        savgol(noisy, reach=1)


def test_a_window_that_a_polynomial_goes_through_is_refused() -> None:
    take = make_recording(np.zeros((50, 1, 3)), rate=20.0)
    with pytest.raises(Refusal, match=r"a window of 0\.15 s is 3 frames at 20 Hz, .* more than 4"):
        savgol(take)


def test_a_window_longer_than_the_take_is_refused(noisy: Trajectories) -> None:
    with pytest.raises(Refusal, match="needs 599 frames in a row"):
        savgol(noisy, window=9.983)
