"""Markers as points without names."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import Detections, Trajectories


def detections(positions: NDArray[np.float64]) -> Detections:
    present = ~np.isnan(positions[..., 0])
    offsets = np.concatenate([[0], np.cumsum(present.sum(axis=1))])
    return Detections(points=positions[present], offsets=offsets, rate=60.0)


def same(tracks: Trajectories, positions: NDArray[np.float64]) -> bool:
    return np.array_equal(tracks.positions, positions, equal_nan=True)
