"""The cubic spline that fits best."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import LSQUnivariateSpline

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.least_squares import least_squares
from tests.plugins.recordings import make_recording


def test_equals_the_spline_of_another_library_routine(noisy: Trajectories) -> None:
    smoothed = least_squares(noisy, spacing=0.1).positions
    frame = np.arange(121.0)
    for marker in range(3):
        for axis in range(3):
            spline = LSQUnivariateSpline(frame, noisy.positions[:, marker, axis], frame[6:-6:6])
            np.testing.assert_allclose(smoothed[:, marker, axis], spline(frame), rtol=0, atol=1e-9)


def test_a_cubic_stays_as_it_is() -> None:
    time = np.linspace(-1, 1, 40)[:, None, None]
    cubic = 10 * time**3 - 4 * time**2 + [[1.0, 2.0, 3.0]] * time
    np.testing.assert_allclose(
        least_squares(make_recording(cubic)).positions, cubic, rtol=0, atol=1e-10
    )


@pytest.mark.parametrize(("spacing", "frames"), [(0.05, "1"), (0.0545, r"1\.09")])
def test_knots_hardly_farther_apart_than_frames_are_refused(spacing: float, frames: str) -> None:
    take = make_recording(np.zeros((50, 1, 3)), rate=20.0)
    pattern = rf"apart are {frames} frames apart at 20 Hz.* at least 1\.1 frames, such as 0\.1 s"
    with pytest.raises(Refusal, match=pattern):
        least_squares(take, spacing=spacing)


def test_knots_that_are_just_far_enough_apart_settle_a_long_run() -> None:
    rng = np.random.default_rng(0)
    take = make_recording(rng.normal(size=(4000, 1, 3)), rate=20.0)
    once = least_squares(take, spacing=0.055)
    assert np.abs(once.positions).max() < 5
    again = least_squares(once, spacing=0.055).positions
    np.testing.assert_allclose(again, once.positions, rtol=0, atol=1e-10)
