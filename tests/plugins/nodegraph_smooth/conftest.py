"""Recordings with all kinds of gaps, and smoothing each run as a recording of its own."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_mocap import Origin, Trajectories

Positions = NDArray[np.float64]


def make_recording(positions: Any, rate: float = 60.0, origin: Any = None) -> Trajectories:
    names = tuple(f"m{index}" for index in range(np.shape(positions)[1]))
    return Trajectories(positions=positions, markers=names, rate=rate, origin=origin)


def make_gappy(seed: int) -> Trajectories:
    """A few markers that walk about, with gaps anywhere, and samples of every origin."""
    random = np.random.default_rng(seed)
    frames, markers = int(random.integers(1, 70)), int(random.integers(1, 5))
    places = random.normal(0, 30, (markers, 3))
    positions = places + np.cumsum(random.normal(0, 1, (frames, markers, 3)), axis=0)
    kinds = [Origin.MEASURED, Origin.MEASURED, Origin.REPAIRED, Origin.FILLED]
    origin = random.choice(kinds, (frames, markers)).astype(np.uint8)
    for _ in range(int(random.integers(0, 3 * markers))):
        marker, start = random.integers(markers), int(random.integers(-8, frames))
        origin[max(start, 0) : start + int(random.integers(1, 14)), marker] = Origin.MISSING
    if random.random() < 0.2:
        origin[:, random.integers(markers)] = Origin.MISSING
    positions[origin == Origin.MISSING] = np.nan
    return make_recording(positions, origin=origin)


def run_quietly(
    smooth: Callable[..., Trajectories], recording: Trajectories, **settings: object
) -> Trajectories:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return smooth(recording, **settings)


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
        alone = make_recording(recording.positions[start:stop, [marker]], recording.rate)
        try:
            expected[start:stop, [marker]] = run_quietly(smooth, alone, **settings).positions
        except Refusal:
            continue
    return expected


@pytest.fixture(scope="session")
def recorded() -> Callable[..., Trajectories]:
    """Positions to a recording."""
    return make_recording


@pytest.fixture(scope="session")
def gappy() -> Callable[[int], Trajectories]:
    """A seed to a recording with gaps."""
    return make_gappy


@pytest.fixture(scope="session")
def quietly() -> Callable[..., Trajectories]:
    """Smooth where warnings do not matter."""
    return run_quietly


@pytest.fixture(scope="session")
def alone() -> Callable[..., Positions]:
    """Smooth each run as a recording of its own."""
    return run_by_run


@pytest.fixture(scope="session")
def noisy() -> Trajectories:
    """Two seconds of three markers that move slowly, with noise."""
    random = np.random.default_rng(5)
    time = np.arange(121)[:, None, None] / 60.0
    speed, phase = random.uniform(0.5, 2.0, (2, 3, 3))
    moves = random.normal(0, 40, (3, 3)) + 8.0 * np.sin(2 * np.pi * speed * time + 6.0 * phase)
    return make_recording(moves + random.normal(0, 0.2, moves.shape))
