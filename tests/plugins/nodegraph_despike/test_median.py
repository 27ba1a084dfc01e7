"""The running median repairs outliers, and only those."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import medfilt

from nodegraph_despike.median import median
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.nodegraph_despike.impulses import hit, make_recording
from tests.plugins.recordings import quietly

ALONG = np.array([2.0, -1.0, 2.0]) / 3.0


@pytest.mark.parametrize("reach", [1, 2, 4])
@pytest.mark.parametrize("threshold", [0.0, 0.5, 2.0])
def test_along_a_line_it_is_the_running_median_beyond_a_threshold(
    reach: int, threshold: float
) -> None:
    values = np.random.default_rng(3).normal(size=200)
    filtered = medfilt(values, 2 * reach + 1)
    expected = np.where(np.abs(values - filtered) > threshold, filtered, values)
    despiked = quietly(median, make_recording(values), reach=reach, threshold=threshold)
    inner = slice(reach, 200 - reach)
    assert despiked.positions[inner, 0] @ ALONG == pytest.approx(expected[inner])
    assert np.any(expected != values)


@pytest.mark.parametrize("width", [1, 2])
def test_finds_impulses_of_up_to_reach_frames_and_leaves_the_rest(
    wavy: Trajectories, width: int
) -> None:
    frames = [start + offset for start in range(10, 110, 25) for offset in range(width)]
    despiked = quietly(median, hit(wavy, frames, [13.0, -12.0, 13.0]), reach=2, threshold=4.0)
    impulses = np.zeros(despiked.origin.shape, dtype=bool)
    impulses[frames] = True
    assert np.array_equal(despiked.origin == Origin.REPAIRED, impulses)
    assert np.array_equal(despiked.positions[~impulses], wavy.positions[~impulses])
    assert np.linalg.norm(despiked.positions - wavy.positions, axis=2).max() < 6.0


def test_a_longer_one_is_taken_for_the_motion(wavy: Trajectories) -> None:
    despiked = quietly(median, hit(wavy, [40, 41, 42], [30.0, -20.0, 40.0]), reach=2)
    assert despiked.origin[41].max() == Origin.MEASURED


def test_clean_motion_stays_at_the_default(wavy: Trajectories) -> None:
    assert median(wavy) is wavy


def test_exactly_the_threshold_is_not_beyond_it() -> None:
    still = np.zeros((20, 1, 3))
    still[7, 0, 1] = 2.0
    assert median(make_recording(still), threshold=2.0).origin.max() == Origin.MEASURED
    assert quietly(median, make_recording(still), threshold=1.99).origin[7, 0] == Origin.REPAIRED
