"""Gaps of a recording are read as they are, and timed for another rate."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_gaps.transplant import read_pattern
from nodegraph_mocap import Origin, Trajectories
from tests.plugins.recordings import make_recording

FRAMES, MARKERS = 60, 5


def with_gaps(*gaps: tuple[int, int, int], rate: float = 100.0) -> Trajectories:
    """Return a recording in which (marker, first frame, length) are missing."""
    missing = np.zeros((FRAMES, MARKERS), dtype=np.bool_)
    for marker, first, length in gaps:
        missing[first : first + length, marker] = True
    return lacking(missing, rate)


def lacking(missing: NDArray[np.bool_], rate: float = 100.0) -> Trajectories:
    positions = np.random.default_rng(0).normal(size=(*missing.shape, 3))
    positions[missing] = np.nan
    return make_recording(positions, rate=rate)


def read(source: Trajectories, rate: float = 100.0) -> list[tuple[int, int, int]]:
    pattern = read_pattern(source, rate)
    columns = (pattern.marker, pattern.start, pattern.length)
    return [(int(m), int(s), int(n)) for m, s, n in zip(*columns, strict=True)]


def test_gaps_are_counted_from_the_first_and_markers_in_order_of_appearance() -> None:
    source = with_gaps((3, 10, 4), (1, 12, 20), (3, 40, 1), (0, 41, 5))
    assert read(source) == [(0, 0, 4), (1, 2, 20), (0, 30, 1), (2, 31, 5)]
    pattern = read_pattern(source, 100.0)
    assert (pattern.span, pattern.markers) == (36, 3)
    assert pattern.together.tolist() == [[5, 2, 0], [2, 20, 0], [0, 0, 5]]


def test_times_are_scaled_to_the_other_rate() -> None:
    source = with_gaps((3, 10, 4), (1, 12, 20), (3, 40, 1), (0, 41, 5))
    # 4, 20, 1, 5 frames at 100 Hz are 2.4, 12, 0.6, 3 at 60 Hz
    assert read(source, 60.0) == [(0, 0, 2), (1, 1, 12), (0, 18, 1), (2, 19, 3)]
    assert read(source, 200.0) == [(0, 0, 8), (1, 4, 40), (0, 60, 2), (2, 62, 10)]
    # 0.1 of 4, 1 and 5 frames is less than one: each is one
    assert [length for *_, length in read(source, 10.0)] == [1, 2, 1, 1]


def test_gaps_of_a_marker_do_not_come_to_touch() -> None:
    source = with_gaps((2, 10, 3), (2, 14, 3), (2, 18, 3), (4, 18, 3))
    assert read(source, 10.0) == [(0, 0, 1), (0, 2, 1), (0, 4, 1), (1, 1, 1)]


def test_what_was_filled_was_missing() -> None:
    source = with_gaps((2, 10, 3), (4, 18, 6))
    filled = source.with_samples(
        np.nan_to_num(source.positions), changed=~source.present, origin=Origin.FILLED
    )
    assert filled.present.all()
    assert read(filled) == read(source)


def test_runs_at_the_ends_are_left_out_and_counted() -> None:
    source = with_gaps((0, 0, 5), (1, FRAMES - 3, 3), (2, 0, FRAMES), (3, 20, 4))
    with pytest.warns(UserWarning, match="3 of 4 runs of missing samples of pattern_from reach"):
        assert read(source) == [(0, 0, 4)]


@pytest.mark.parametrize(
    ("gaps", "runs"), [((), 0), (((0, 0, 5), (2, 0, FRAMES), (1, FRAMES - 3, 3)), 3)]
)
def test_without_gaps_there_is_no_pattern(gaps: tuple[tuple[int, int, int]], runs: int) -> None:
    with pytest.raises(ValueError, match=f"no gap with a measured sample .*: {runs} runs of miss"):
        read_pattern(with_gaps(*gaps), 60.0)


@given(
    missing=arrays.arrays(np.bool_, (20, 4)),
    rate=st.sampled_from([10.0, 30.0, 60.0, 100.0, 120.0, 250.0]),
)
@pytest.mark.filterwarnings("ignore:.*runs of missing samples of pattern_from reach")
def test_a_pattern_has_every_inner_gap_apart(missing: NDArray[np.bool_], rate: float) -> None:
    missing[[0, -1]] = False
    missing[5, 0] = True
    pattern = read_pattern(lacking(missing), rate)
    starts = missing[1:] & ~missing[:-1]
    assert len(pattern.length) == np.count_nonzero(starts)
    assert pattern.start.min() == 0
    assert pattern.length.min() >= 1
    assert pattern.markers == np.count_nonzero(missing.any(axis=0))
    for marker in range(pattern.markers):
        mine = pattern.marker == marker
        ends = pattern.start[mine] + pattern.length[mine]
        assert (pattern.start[mine][1:] > ends[:-1]).all()
    if rate == 100.0:
        assert pattern.length.sum() == np.count_nonzero(missing)
