"""A low-pass filter whose cut-off rises with the speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_smooth.one_euro import one_euro


def plainly(
    run: NDArray[np.float64], rate: float, least: float, slope: float, derivative: float
) -> NDArray[np.float64]:
    """The authors' algorithm, for a point in space."""

    def share(cutoff: float) -> float:
        tau = 1.0 / (2 * np.pi * cutoff)
        return 1.0 / (1.0 + tau * rate)

    expected, velocity = [run[0]], np.zeros(3)
    for sample in run[1:]:
        step = (sample - expected[-1]) * rate
        velocity = share(derivative) * step + (1 - share(derivative)) * velocity
        alpha = share(least + slope * float(np.linalg.norm(velocity)))
        expected.append(alpha * sample + (1 - alpha) * expected[-1])
    return np.array(expected)


@pytest.mark.parametrize("settings", [(3.0, 0.5, 1.0), (1.0, 0.0, 1.0), (0.2, 3.0, 5.0)])
def test_is_the_authors_algorithm(
    noisy: Trajectories, settings: tuple[float, float, float]
) -> None:
    least, slope, derivative = settings
    smoothed = one_euro(noisy, min_cutoff=least, beta=slope, derivative_cutoff=derivative)
    for marker in range(3):
        expected = plainly(noisy.positions[:, marker], 60.0, *settings)
        np.testing.assert_allclose(smoothed.positions[:, marker], expected, rtol=1e-12, atol=1e-12)


def test_sees_no_frame_ahead(noisy: Trajectories) -> None:
    whole = one_euro(noisy).positions
    for count in (1, 2, 60):
        start = replace(noisy, positions=noisy.positions[:count], origin=noisy.origin[:count])
        np.testing.assert_array_equal(one_euro(start).positions, whole[:count])


def test_bad_settings(noisy: Trajectories) -> None:
    for wrong in ({"min_cutoff": 0.0}, {"derivative_cutoff": -1.0}, {"beta": -0.1}):
        with pytest.raises(ValueError, match="cut-offs must be positive and beta not negative"):
            one_euro(noisy, **wrong)
