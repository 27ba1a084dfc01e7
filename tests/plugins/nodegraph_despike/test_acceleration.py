"""Spikes by acceleration against a plain statement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_despike.acceleration import acceleration
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.nodegraph_despike.impulses import hit, make_gappy, make_recording
from tests.plugins.recordings import quietly


def plainly(recording: Trajectories, threshold: float) -> np.ndarray:
    expected = recording.positions.copy()
    for marker in range(len(recording.markers)):
        track, bad = recording.positions[:, marker], [False] * recording.frames
        for i in range(1, recording.frames - 1):
            bend = (track[i + 1] - 2 * track[i] + track[i - 1]) * recording.rate**2
            bad[i] = bool(np.linalg.norm(bend) > threshold)
        i = 0
        while i < len(bad):
            first = i
            while i < len(bad) and bad[i]:
                i += 1
            for frame in range(first, i):
                share = (frame - first + 1) / (i - first + 1)
                expected[frame, marker] = (1 - share) * track[first - 1] + share * track[i]
            i += 1
    return expected


@given(seed=st.integers(0, 10_000), threshold=st.sampled_from([1e3, 1e4, 1e5]))
def test_equals_a_plain_statement(seed: int, threshold: float) -> None:
    recording = make_gappy(seed)
    despiked = quietly(acceleration, recording, threshold=threshold)
    expected = plainly(recording, threshold)
    assert np.allclose(despiked.positions, expected, rtol=0, atol=1e-9, equal_nan=True)
    changed = recording.present & np.any(despiked.positions != recording.positions, axis=2)
    assert np.all(despiked.origin[changed] == Origin.REPAIRED)


@pytest.mark.parametrize(("rate", "least"), [(60.0, 2.8), (30.0, 11.2), (100.0, 1.0)])
def test_the_least_impulse_that_is_bad(rate: float, least: float) -> None:
    def repaired(size: float) -> list[int]:
        line = np.zeros(30)
        line[9] = size
        despiked = quietly(acceleration, make_recording(line, rate=rate))
        return list(np.flatnonzero(despiked.origin == Origin.REPAIRED))

    assert repaired(0.95 * least) == []
    assert repaired(1.05 * least) == [9]


def test_a_large_impulse_takes_its_neighbours_with_it() -> None:
    line = np.arange(30.0) ** 2 * 0.01
    spiky = line.copy()
    spiky[9] += 20.0
    despiked = quietly(acceleration, make_recording(spiky))
    assert np.flatnonzero(despiked.origin == Origin.REPAIRED).tolist() == [8, 9, 10]
    # On the line from frame 7 to frame 11, which is a little above the parabola.
    off = np.linalg.norm(despiked.positions - make_recording(line).positions, axis=2)[:, 0]
    assert off[[8, 9, 10]] == pytest.approx([0.03, 0.04, 0.03])


@pytest.mark.parametrize("width", [1, 2])
def test_impulses_of_one_and_two_frames_are_found(wavy: Trajectories, width: int) -> None:
    frames = [start + offset for start in range(10, 110, 20) for offset in range(width)]
    despiked = quietly(acceleration, hit(wavy, frames, [12.0, -9.0, 8.0]))
    assert np.all(despiked.origin[frames] == Origin.REPAIRED)
    assert np.abs(despiked.positions - wavy.positions).max() < 2.0


def test_of_a_longer_one_only_the_edges_are(wavy: Trajectories) -> None:
    despiked = quietly(acceleration, hit(wavy, [40, 41, 42], [12.0, -9.0, 8.0]))
    repaired = despiked.origin[:, 0] == Origin.REPAIRED
    assert np.flatnonzero(repaired).tolist() == [39, 40, 42, 43]


def test_the_good_sample_between_two_impulses_is_saved(wavy: Trajectories) -> None:
    despiked = quietly(acceleration, hit(wavy, [10, 12], [12.0, -9.0, 8.0]))
    assert np.abs(despiked.positions - wavy.positions).max() < 2.0


def test_at_the_ends_and_beside_gaps_there_is_no_acceleration() -> None:
    line = np.zeros(20)
    line[[8, 12]] = 50.0
    line[[7, 9, 11, 13]] = np.nan
    recording = make_recording(line)
    assert acceleration(recording) is recording
