"""Recordings with impulses of known place."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import Origin, Trajectories
from tests.plugins import recordings

Positions = NDArray[np.float64]


def make_recording(positions: object, origin: Any = None, rate: float = 60.0) -> Trajectories:
    """(T, M, 3), or (T,) or (T, M) along a slanting line, to a recording."""
    array = np.asarray(positions, dtype=np.float64)
    if array.ndim < 3:
        along = np.array([2.0, -1.0, 2.0]) / 3.0
        array = (array[:, None] if array.ndim == 1 else array)[..., None] * along
    return recordings.make_recording(array, origin, rate)


def make_gappy(seed: int) -> Trajectories:
    """A few markers that walk about, with impulses and gaps anywhere, and every origin."""
    random = np.random.default_rng(seed)
    frames, markers = int(random.integers(1, 40)), int(random.integers(1, 5))
    positions = np.cumsum(random.normal(0, 1, (frames, markers, 3)), axis=0)
    positions[random.random((frames, markers)) < 0.1] += random.normal(0, 20, 3)
    kinds = [Origin.MEASURED, Origin.MEASURED, Origin.REPAIRED, Origin.FILLED, Origin.MISSING]
    origin = random.choice(kinds, (frames, markers)).astype(np.uint8)
    origin[random.random((frames, markers)) < 0.6] = Origin.MEASURED
    positions[origin == Origin.MISSING] = np.nan
    return make_recording(positions, origin)


def make_wavy(frames: int = 120, markers: int = 6) -> Trajectories:
    """Markers that move smoothly, each in its own way, with a little noise."""
    random = np.random.default_rng(7)
    period, phase = random.uniform(30, 90, (2, markers, 3))
    time = np.arange(frames)[:, None, None]
    waves = 8.0 * np.sin(2 * np.pi * (time / period + phase))
    return make_recording(waves + random.normal(0, 0.02, waves.shape))


def hit(recording: Trajectories, frames: list[int], off: Any) -> Trajectories:
    """Put all markers off in some frames."""
    positions = recording.positions.copy()
    positions[frames] += off
    return make_recording(positions, recording.origin, recording.rate)
