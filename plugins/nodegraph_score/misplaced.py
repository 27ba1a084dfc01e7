"""Samples that are where another marker should be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.pieces import pieces

if TYPE_CHECKING:
    from numpy.typing import NDArray


def misplaced(positions: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (T, M), True where a sample is nearer to another marker's truth than to its own.

    Parameters
    ----------
    positions, truth
        (T, M, 3) of the same markers; NaN where missing. A sample without a truth is not.
    """
    found = np.zeros(positions.shape[:2], dtype=np.bool_)
    markers = positions.shape[1]
    for piece in pieces(len(positions), 8 * markers * markers):
        found[piece] = _misplaced(positions[piece], truth[piece])
    return found


def _misplaced(positions: NDArray[np.float64], truth: NDArray[np.float64]) -> NDArray[np.bool_]:
    # |p - x|^2 without the |p|^2 that all x have in common, and about the middle of the markers,
    # so that nothing is lost to their distance from the origin
    middle = np.nan_to_num(truth).mean(axis=1, keepdims=True)
    here, there = positions - middle, truth - middle
    lengths = np.sum(there**2, axis=2)
    apart = lengths[:, None, :] - 2.0 * (np.nan_to_num(here) @ np.nan_to_num(there).swapaxes(1, 2))
    own = np.diagonal(apart, axis1=1, axis2=2)
    nearest = np.where(np.isnan(apart), np.inf, apart).min(axis=2, initial=np.inf)
    return np.asarray(np.isfinite(here[..., 0]) & (nearest < own))
