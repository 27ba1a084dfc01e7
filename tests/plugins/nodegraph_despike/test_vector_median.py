"""Running vector medians against a plain statement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_despike.vector_median import running_median, running_spread
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_despike.impulses import make_gappy, make_recording


def plain_window(recording: Trajectories, marker: int, now: int, reach: int) -> list[int]:
    """Frames of the window; none where the sample is not judged."""
    present = recording.present[:, marker]
    frames = range(max(0, now - reach), min(recording.frames, now + reach + 1))
    window = [frame for frame in frames if present[frame]]
    judged = present[now] and window[0] < now < window[-1]
    return window if judged else []


def plain_median(recording: Trajectories, marker: int, now: int, window: list[int]) -> int:
    track = recording.positions[:, marker]
    sums = {
        frame: sum(np.linalg.norm(track[frame] - track[other]) for other in window)
        for frame in window
    }
    least = min(sums.values())
    near = [frame for frame in window if sums[frame] <= least * (1 + 1e-9)]
    return min(near, key=lambda value: (abs(value - now), value))


@given(seed=st.integers(0, 10_000), reach=st.integers(1, 6))
def test_equals_a_plain_statement(seed: int, reach: int) -> None:
    recording = make_gappy(seed)
    median, distance = running_median(recording.positions, reach)
    spread = running_spread(recording.positions, median, reach)
    for now, marker in np.ndindex(recording.origin.shape):
        track = recording.positions[:, marker]
        window = plain_window(recording, marker, now, reach)
        if not window:
            assert spread[now, marker] == np.inf
            assert np.array_equal(median[now, marker], track[now], equal_nan=True)
            continue
        frame = plain_median(recording, marker, now, window)
        apart = np.linalg.norm(track[window] - track[frame], axis=1)
        assert np.array_equal(median[now, marker], track[frame])
        assert distance[now, marker] == pytest.approx(np.linalg.norm(track[now] - track[frame]))
        assert spread[now, marker] == pytest.approx(np.median(apart))


def test_along_a_line_it_is_the_median() -> None:
    values = np.random.default_rng(4).normal(size=50)
    recording = make_recording(values)
    median, _ = running_median(recording.positions, 3)
    spread = running_spread(recording.positions, median, 3)
    along = np.array([2.0, -1.0, 2.0]) / 3.0
    for now in range(3, 47):
        window = values[now - 3 : now + 4]
        assert median[now, 0] @ along == pytest.approx(np.median(window))
        expected = np.median(np.abs(window - np.median(window)))
        assert spread[now, 0] == pytest.approx(expected)


def test_of_two_middle_ones_the_nearer_is_taken_and_then_the_earlier() -> None:
    # At frame 1 the window is cut off to 0 .. 3: frames 1 and 2 lie equally in the middle.
    line = make_recording(np.arange(8.0) * 0.1)
    median, distance = running_median(line.positions, 2)
    assert np.array_equal(median, line.positions)
    assert np.all(distance == 0)
    lacking = make_recording([0.0, 1.0, 5.0, 2.0, 3.0, 4.0, 4.5])
    middle, _ = running_median(lacking.positions, 1)
    assert np.array_equal(middle[2, 0], lacking.positions[3, 0])


def test_a_window_longer_than_the_take_is_the_take() -> None:
    recording = make_recording(np.random.default_rng(5).normal(size=9))
    median, distance = running_median(recording.positions, 8)
    farther, far = running_median(recording.positions, 2**62)
    assert np.array_equal(farther, median)
    assert np.array_equal(far, distance)
    spread = running_spread(recording.positions, median, 8)
    assert np.array_equal(running_spread(recording.positions, median, 2**62), spread)
