"""The nearest marker's trajectory, bent to meet both ends of the gap."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from nodegraph_fill.pattern import pattern
from nodegraph_mocap import Origin
from tests.plugins.nodegraph_fill.plain_fills import plain_gaps
from tests.plugins.recordings import make_gappy, make_recording, quietly


def line(body: NDArray[np.float64], first: int, last: int, frame: int) -> NDArray[np.float64]:
    return np.asarray(body[first] + (body[last] - body[first]) * (frame - first) / (last - first))


@given(seed=st.integers(0, 2**32 - 1), max_gap=st.sampled_from([None, 3]))
def test_equals_the_plain_formula(seed: int, max_gap: int | None) -> None:
    recording = make_gappy(seed)
    expected = recording.positions.copy()
    for marker, start, stop in plain_gaps(recording.origin):
        first, last = start - 1, stop
        if first < 0 or last == recording.frames or (max_gap and stop - start > max_gap):
            continue
        apart = [
            (float(np.linalg.norm(recording.positions[first, other] - expected[first, marker])), o)
            for o, other in enumerate(range(len(recording.markers)))
            if recording.present[first : last + 1, other].all()
        ]
        if not apart:
            continue
        donor = recording.positions[:, min(apart)[1]]
        own = recording.positions[:, marker]
        for frame in range(start, stop):
            expected[frame, marker] = (
                line(own, first, last, frame) - line(donor, first, last, frame) + donor[frame]
            )
    filled = quietly(pattern, recording, max_gap=max_gap)
    np.testing.assert_allclose(filled.positions, expected, rtol=0, atol=1e-9)


def test_without_a_donor_the_gap_is_left_and_reported() -> None:
    positions = np.ones((9, 2, 3))
    positions[3:6, 0] = positions[5, 1] = positions[8, 1] = np.nan
    message = (
        "^5 samples of 2 markers left missing: at the take's end 1, "
        "no marker without a hole there 4$"
    )
    with pytest.warns(UserWarning, match=message):
        filled = pattern(make_recording(positions))
    assert not np.any(filled.origin == Origin.FILLED)
