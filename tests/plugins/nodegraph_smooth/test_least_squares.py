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


def test_knots_no_farther_apart_than_frames_are_refused() -> None:
    take = make_recording(np.zeros((50, 1, 3)), rate=20.0)
    with pytest.raises(Refusal, match=r"knots 0\.05 s apart are 1 frames apart at 20 Hz"):
        least_squares(take)
