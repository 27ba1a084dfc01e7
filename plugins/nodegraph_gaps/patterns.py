"""Which markers may be hidden together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_mocap.reference_shape import reference_shape

_DIRECTIONS = 72


def groups_of(pattern: str, recording: Trajectories, size: int) -> NDArray[np.intp] | None:
    """Return the groups of markers that an event may hide, or None where any may be.

    Returns
    -------
    (G, size) array of marker indices, or None
    """
    if size == 1 or pattern in ("random", "end"):
        return None
    shape = reference_shape(recording)
    there = np.flatnonzero(np.isfinite(shape[:, 0]))
    if len(there) < size:
        return np.empty((0, size), dtype=np.intp)
    group = _nearest if pattern == "contiguous" else _outermost
    return np.asarray(there[group(shape[there], size)])


def _nearest(shape: NDArray[np.float64], size: int) -> NDArray[np.intp]:
    """Return each marker with those nearest to it."""
    apart = np.linalg.norm(shape[:, None] - shape[None], axis=2)
    return np.argsort(apart, axis=1, kind="stable")[:, :size]


def _outermost(shape: NDArray[np.float64], size: int) -> NDArray[np.intp]:
    """Return the markers farthest out in each of many directions of the face's plane."""
    centred = shape - shape.mean(axis=0)
    plane = np.linalg.svd(centred, full_matrices=False)[2][:2]
    angles = np.arange(_DIRECTIONS) * (2 * np.pi / _DIRECTIONS)
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)[:, : len(plane)] @ plane
    order = np.argsort(-(directions @ centred.T), axis=1, kind="stable")
    return np.unique(np.sort(order[:, :size], axis=1), axis=0)
