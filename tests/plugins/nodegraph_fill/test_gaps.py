"""Gaps as arrays, and the account of what is left."""

from __future__ import annotations

import numpy as np

from nodegraph_fill.gaps import Gaps
from nodegraph_mocap import Origin
from tests.plugins.recordings import make_gappy, make_recording


def test_gaps_are_the_runs_of_missing_samples() -> None:
    for seed in range(40):
        recording = make_gappy(seed)
        gaps = Gaps.of(recording)
        np.testing.assert_array_equal(gaps.mask, recording.origin == Origin.MISSING)
        for marker, start, stop in zip(gaps.marker, gaps.start, gaps.stop, strict=True):
            assert start == 0 or recording.present[start - 1, marker]
            assert stop == recording.frames or recording.present[stop, marker]
        parts = np.stack([gaps.never, gaps.at_start, gaps.at_end, gaps.inner])
        np.testing.assert_array_equal(parts.sum(axis=0), 1)


def test_the_share_of_the_way_leaves_both_ends_out() -> None:
    positions = np.zeros((6, 1, 3))
    positions[1:4] = np.nan
    gap, frame, marker, share = Gaps.of(make_recording(positions)).samples
    assert (gap.tolist(), frame.tolist(), marker.tolist()) == ([0] * 3, [1, 2, 3], [0] * 3)
    assert share.tolist() == [0.25, 0.5, 0.75]
