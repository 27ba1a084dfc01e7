"""Zero phase, half the amplitude at the cut-off."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.butterworth import butterworth
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize("order", [1, 2, 5, 10])
@pytest.mark.parametrize(("cutoff", "rate"), [(3.0, 60.0), (10.0, 60.0), (25.0, 240.0)])
def test_amplitude_kept(order: int, cutoff: float, rate: float) -> None:
    frame = np.arange(4001)
    for share in (0.5, 1.0, 1.5):
        # with the bilinear transform a frequency f acts as tan(pi f / rate)
        hertz = rate / np.pi * np.arctan(share * np.tan(np.pi * cutoff / rate))
        wave = np.cos(2 * np.pi * hertz / rate * (frame - 2000))
        positions = np.repeat(wave[:, None, None], 3, axis=2)
        smoothed = butterworth(make_recording(positions, rate=rate), cutoff=cutoff, order=order)
        middle = smoothed.positions[1000:3001, 0, 0]
        expected = wave[1000:3001] / (1.0 + share ** (2 * order))
        np.testing.assert_allclose(middle, expected, rtol=0, atol=2e-4)


@pytest.mark.parametrize(("cutoff", "order"), [(8.0, 3), (10.0, 2), (4.0, 1), (12.0, 6)])
def test_is_a_forward_and_a_backward_pass_over_what_is_turned_about_its_ends(
    noisy: Trajectories, cutoff: float, order: int
) -> None:
    smoothed = butterworth(noisy, cutoff=cutoff, order=order).positions
    sections = butter(order, cutoff / 30.0, output="sos")
    expected = sosfiltfilt(sections, noisy.positions, axis=0, padtype="odd", padlen=120)
    np.testing.assert_allclose(smoothed, expected, rtol=0, atol=1e-6)


@pytest.mark.parametrize("frames", [1, 2, 3, 50])
def test_a_straight_line_and_the_end_samples_stay(frames: int) -> None:
    line = np.arange(float(frames))[:, None, None] * [[1.0, -2.0, 0.5]] - 40.0
    np.testing.assert_allclose(
        butterworth(make_recording(line)).positions, line, rtol=0, atol=1e-12
    )
    run = np.random.default_rng(1).normal(0, 1, (frames, 1, 3))
    smoothed = butterworth(make_recording(run)).positions
    np.testing.assert_allclose(smoothed[[0, -1]], run[[0, -1]], rtol=0, atol=1e-15)


@pytest.mark.parametrize("order", [1, 10])
@pytest.mark.parametrize("frames", [1, 2, 3, 30])
def test_a_cut_off_far_longer_than_the_take_leaves_a_straight_line(frames: int, order: int) -> None:
    run = np.random.default_rng(3).normal(0, 1, (frames, 1, 3))
    smoothed = butterworth(make_recording(run, rate=240.0), cutoff=0.001, order=order).positions
    way = np.linspace(0.0, 1.0, frames)[:, None, None]
    np.testing.assert_allclose(smoothed, run[0] + way * (run[-1] - run[0]), rtol=0, atol=1e-5)


def test_a_cut_off_above_half_the_rate_is_refused(noisy: Trajectories) -> None:
    with pytest.raises(Refusal, match="cut-off 30 Hz is not below 30 Hz, half the frame rate"):
        butterworth(noisy, cutoff=30.0)
