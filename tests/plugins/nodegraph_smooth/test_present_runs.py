"""Runs of present samples, and what is told of those that stay as they were."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph import Refusal, get_node
from nodegraph_smooth.present_runs import Runs, long_enough, smooth_runs, smoothed
from tests.plugins.recordings import make_gappy, make_recording


@given(seed=st.integers(0, 2**32 - 1))
def test_runs_are_the_present_samples(seed: int) -> None:
    recording = make_gappy(seed, most_frames=70, most_markers=5)
    runs = Runs.of(recording)
    actual = np.zeros_like(recording.present)
    for marker, start, stop in zip(runs.marker, runs.start, runs.stop, strict=True):
        assert recording.present[start:stop, marker].all()
        assert start == 0 or not recording.present[start - 1, marker]
        assert stop == recording.frames or not recording.present[stop, marker]
        actual[start:stop, marker] = True
    np.testing.assert_array_equal(actual, recording.present)


def test_runs_of_one_length_are_given_together() -> None:
    positions = np.random.default_rng(1).normal(0, 1, (9, 3, 3))
    positions[4, 0] = positions[4, 1] = positions[2, 2] = np.nan
    recording = make_recording(positions)
    groups = [(length, runs.marker.tolist()) for length, runs in Runs.of(recording).by_length()]
    assert groups == [(2, [2]), (4, [0, 0, 1, 1]), (6, [2])]


def test_equally_long_runs_are_given_some_at_a_time() -> None:
    (length, runs), *_ = Runs.of(make_recording(np.zeros((9, 5, 3)))).by_length()
    for most, expected in ((20, [[0, 1], [2, 3], [4]]), (5, [[0], [1], [2], [3], [4]])):
        assert [some.marker.tolist() for some in runs.together(most)] == expected
    assert length == 9


@pytest.mark.parametrize("name", ["butterworth", "dct", "gcv", "one_euro", "savgol", "whittaker"])
def test_it_does_not_matter_how_many_are_given_at_a_time(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    walk = np.random.default_rng(2).normal(0, 1, (97, 7, 3)).cumsum(axis=0)
    walk[40:43, 2] = np.nan
    smooth = get_node(f"smooth.{name}")
    together = smooth(make_recording(walk)).positions
    monkeypatch.setattr("nodegraph_smooth.present_runs._TOGETHER", 200)
    apart = smooth(make_recording(walk)).positions
    # a product of matrices adds up in an order that depends on their size
    np.testing.assert_allclose(apart, together, rtol=0, atol=1e-13 if name == "savgol" else 0)


def test_short_runs_stay_and_are_counted() -> None:
    positions = np.random.default_rng(1).normal(0, 1, (9, 2, 3))
    positions[[2, 8], 0] = np.nan
    recording = make_recording(positions)
    message = "1 of 3 runs of present samples \\(2 samples\\) are shorter than 4 frames and stay"
    with pytest.warns(UserWarning, match=message):
        smoothed = smooth_runs(recording, np.zeros_like, shortest=4)
    np.testing.assert_array_equal(
        smoothed.positions[:2], np.stack([positions[:2, 0], positions[[0, 0], 1]], 1)
    )
    np.testing.assert_array_equal(smoothed.positions[3:8, 0], np.tile(positions[3, 0], (5, 1)))


def test_nothing_but_short_runs_is_refused() -> None:
    positions = np.zeros((9, 1, 3))
    positions[5] = np.nan
    with pytest.raises(Refusal, match="needs 6 frames in a row; the longest run of present sampl"):
        long_enough(Runs.of(make_recording(positions)), 6)


def test_nothing_present_is_reported() -> None:
    recording = make_recording(np.full((4, 2, 3), np.nan))
    with pytest.warns(UserWarning, match="^no sample is present: there is nothing to smooth$"):
        smoothed = smooth_runs(recording, np.zeros_like, shortest=2)
    assert not smoothed.present.any()


def test_a_method_is_given_runs_relative_to_their_first_samples() -> None:
    positions = np.random.default_rng(1).normal(500, 1, (5, 2, 3))
    seen = []
    smooth_runs(make_recording(positions), lambda block: seen.append(block) or block)  # type: ignore[func-returns-value]
    np.testing.assert_array_equal(seen[0], positions - positions[0])


def test_sigma_goes_with_the_sample_that_it_was_of() -> None:
    recording = replace(make_recording(np.zeros((3, 2, 3))), sigma=np.full((3, 2), 0.1))
    positions = np.zeros((3, 2, 3))
    positions[1, 1, 2] = 1e-9
    output = smoothed(recording, positions)
    assert output.sigma is not None
    assert np.argwhere(np.isnan(output.sigma)).tolist() == [[1, 1]]
    assert np.nanmin(output.sigma) == 0.1
