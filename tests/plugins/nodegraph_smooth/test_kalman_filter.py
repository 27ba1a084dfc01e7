"""The filter knows what the smoother knows of a run that ends at its frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from nodegraph_smooth.kalman import Motion, kalman
from nodegraph_smooth.kalman_filter import kalman_filter
from tests.plugins.recordings import make_recording


@pytest.mark.parametrize(("motion", "order"), [("velocity", 2), ("acceleration", 3)])
@pytest.mark.parametrize("cutoff", [2.0, 10.0])
def test_each_sample_is_the_last_of_the_smoother_so_far(
    noisy: Trajectories, motion: Motion, order: int, cutoff: float
) -> None:
    filtered = kalman_filter(noisy, cutoff=cutoff, motion=motion, noise=0.3)
    assert filtered.sigma is not None
    np.testing.assert_allclose(filtered.positions[:order], noisy.positions[:order], atol=1e-12)
    np.testing.assert_allclose(filtered.sigma[:order], 0.3, rtol=1e-12)
    for count in (order + 1, order + 2, 20, noisy.frames):
        start = replace(noisy, positions=noisy.positions[:count], origin=noisy.origin[:count])
        smoothed = kalman(start, cutoff=cutoff, motion=motion, noise=0.3)
        assert smoothed.sigma is not None
        np.testing.assert_allclose(
            filtered.positions[count - 1], smoothed.positions[-1], rtol=0, atol=1e-6
        )
        np.testing.assert_allclose(filtered.sigma[count - 1], smoothed.sigma[-1], rtol=1e-6)


def test_bad_settings(noisy: Trajectories) -> None:
    with pytest.raises(ValueError, match="motion must be velocity or acceleration"):
        kalman_filter(noisy, motion="jerk")
    with pytest.raises(ValueError, match="noise must be a positive number"):
        kalman_filter(noisy, noise=0.0)
    with pytest.raises(Refusal, match="cut-off 30 Hz is not below 30 Hz"):
        kalman_filter(noisy, cutoff=30.0)
    with pytest.raises(Refusal, match="too low"):
        kalman_filter(
            make_recording(np.zeros((9, 1, 3)), rate=1000.0), cutoff=0.01, motion="acceleration"
        )
