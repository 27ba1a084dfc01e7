"""Smoothing each run of present samples as a recording of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_mocap import Trajectories
from tests.plugins.recordings import make_recording, quietly

Positions = NDArray[np.float64]


def plain_runs(present: NDArray[np.bool_]) -> Iterator[tuple[int, int, int]]:
    """Marker, first present frame, first frame after, of every run of present samples."""
    for marker in range(present.shape[1]):
        start = None
        for frame in range(len(present) + 1):
            there = frame < len(present) and present[frame, marker]
            if there and start is None:
                start = frame
            if not there and start is not None:
                yield marker, start, frame
                start = None


def run_by_run(
    smooth: Callable[..., Trajectories], recording: Trajectories, **settings: object
) -> Positions:
    """Each run of present samples smoothed as a recording of its own; refused ones stay."""
    expected: Positions = recording.positions.copy()
    for marker, start, stop in plain_runs(recording.present):
        alone = make_recording(recording.positions[start:stop, [marker]], rate=recording.rate)
        try:
            expected[start:stop, [marker]] = quietly(smooth, alone, **settings).positions
        except Refusal:
            continue
    return expected
