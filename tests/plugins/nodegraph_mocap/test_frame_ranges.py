"""Runs of True are those that a reader finds going down each column; chunks are all frames."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from numpy.typing import NDArray

from nodegraph_mocap.frame_ranges import chunks, runs_of


def plainly(flags: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    result = []
    for marker in range(flags.shape[1]):
        frame = 0
        while frame < len(flags):
            stop = frame
            while stop < len(flags) and flags[stop, marker]:
                stop += 1
            if stop > frame:
                result.append((marker, frame, stop))
            frame = stop + 1
    return result


@given(arrays.arrays(np.bool_, st.tuples(st.integers(0, 12), st.integers(0, 4))))
def test_they_are_those_that_a_reader_finds(flags: NDArray[np.bool_]) -> None:
    assert list(zip(*(value.tolist() for value in runs_of(flags)), strict=True)) == plainly(flags)


@pytest.mark.parametrize("frames", [0, 1, 2, 54_321])
@pytest.mark.parametrize("frame_bytes", [0, 24, 2**20])
def test_chunks_are_all_frames_and_small(frames: int, frame_bytes: int) -> None:
    parts = list(chunks(frames, frame_bytes))
    assert [frame for part in parts for frame in range(part.start, part.stop)] == [*range(frames)]
    assert all(0 < part.stop - part.start <= max(1, 2**20 // max(1, frame_bytes)) for part in parts)
