"""The Hampel filter against its formula in one dimension, and in space."""

from __future__ import annotations

import numpy as np
import pytest

from nodegraph_despike.hampel import hampel
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.nodegraph_despike.impulses import hit, make_recording
from tests.plugins.recordings import quietly

ALONG = np.array([2.0, -1.0, 2.0]) / 3.0


@pytest.mark.parametrize("reach", [1, 3, 5])
@pytest.mark.parametrize("threshold", [0.0, 1.0, 3.0])
def test_along_a_line_it_is_the_filter_in_one_dimension(reach: int, threshold: float) -> None:
    values = np.random.default_rng(2).standard_t(2, size=200)
    despiked = quietly(hampel, make_recording(values), reach=reach, threshold=threshold)
    bad = 0
    for now in range(reach, 200 - reach):
        window = values[now - reach : now + reach + 1]
        middle = np.median(window)
        scale = 1.4826 * np.median(np.abs(window - middle))
        is_bad = abs(values[now] - middle) > threshold * scale
        bad += is_bad
        assert despiked.positions[now, 0] @ ALONG == pytest.approx(
            middle if is_bad else values[now]
        )
        assert (despiked.origin[now, 0] == Origin.REPAIRED) == is_bad
    assert bad > 5


@pytest.mark.parametrize("width", [1, 2, 3])
def test_finds_impulses_of_up_to_reach_frames(wavy: Trajectories, width: int) -> None:
    frames = [start + offset for start in range(10, 110, 25) for offset in range(width)]
    despiked = quietly(hampel, hit(wavy, frames, [30.0, -20.0, 40.0]), reach=3)
    assert np.all(despiked.origin[frames] == Origin.REPAIRED)
    assert np.abs(despiked.positions - wavy.positions).max() < 5.0


def test_a_longer_one_is_taken_for_the_motion(wavy: Trajectories) -> None:
    despiked = quietly(hampel, hit(wavy, [40, 41, 42, 43], [30.0, -20.0, 40.0]), reach=3)
    assert np.all(despiked.origin[[41, 42]] == Origin.MEASURED)


def test_a_marker_that_stands_still_but_once() -> None:
    still = np.full(30, 4.2)
    assert hampel(make_recording(still)).origin.max() == Origin.MEASURED
    still[12] += 0.01
    despiked = quietly(hampel, make_recording(still))
    assert np.flatnonzero(despiked.origin == Origin.REPAIRED).tolist() == [12]
    assert np.all(despiked.positions == despiked.positions[0])


def test_steady_motion_is_never_bad_not_even_beside_gaps() -> None:
    line = np.arange(60.0) * 3.1
    line[[20, 21, 40]] = np.nan
    recording = make_recording(line)
    assert hampel(recording) is recording


def test_the_first_and_the_last_sample_are_not_judged() -> None:
    line = np.arange(60.0) * 0.1
    line[[0, 59]] += 50.0
    recording = make_recording(line)
    assert hampel(recording) is recording
