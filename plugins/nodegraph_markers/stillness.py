"""Shape of a face in the frame of its head, and the motion of each marker there."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_markers.rigid import fit
from nodegraph_mocap.reference_shape import reference_shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

_FRAMES, _ROUNDS, _FEWEST = 600, 30, 4
_TOLERANCE = 1e-6
_HIGH = 90.0
"""Percentile that stands for a marker's motion: above a few impulses, not above all blinks."""


class HeadFrame(NamedTuple):
    """A take without its head motion.

    Attributes
    ----------
    shape : (M, 3) array of float64
        Median place of each marker, mm, along the shape's principal axes; NaN for one that is
        never present.
    motion : (M,) array of float64, or None
        Distance from there, 90th percentile over the frames, mm; None for a single frame.
    """

    shape: NDArray[np.float64]
    motion: NDArray[np.float64] | None


def head_frame(recording: Trajectories) -> HeadFrame:
    """Return a take's shape and motion without the motion of the head.

    Each frame is fitted rigidly to the shape by the half of the markers that moves least, which
    is found in turns: fit, take the median shape, choose the half, fit again. At most 600
    frames, evenly spread over the take, are looked at.

    Parameters
    ----------
    recording
        A recording of at least four markers that are ever present.
    """
    shape = _upright(reference_shape(recording))
    seen = np.flatnonzero(recording.present.any(axis=1))
    frames = seen[np.unique(np.linspace(0, len(seen) - 1, _FRAMES).astype(np.intp))]
    if len(frames) < 2:
        return HeadFrame(shape, None)
    positions, present = recording.positions[frames], recording.present[frames]
    still = ~np.isnan(shape[:, 0])
    size = max(_FEWEST, int(still.sum()) // 2)
    for _ in range(_ROUNDS):
        poses = fit(positions, shape, (present & still).astype(np.float64))
        aligned = poses.apply(np.where(poses.known[:, None, None], positions, np.nan))
        median, motion = _median_and_motion(aligned, shape)
        before = shape, still
        # the median of coordinates may turn a little in every round, and must not keep turning
        shape = fit(median[np.newaxis], shape, still[np.newaxis] * 1.0).apply(median[np.newaxis])[0]
        still = np.zeros_like(still)
        still[np.argsort(motion, kind="stable")[:size]] = True
        if np.array_equal(before[1], still) and _alike(before[0], shape):
            break
    return HeadFrame(shape, motion)


def _upright(shape: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a shape along its principal axes, turned but not mirrored.

    The median of coordinates depends on their axes; along these, not on the pose of the take.
    """
    known = ~np.isnan(shape[:, 0])
    centred = shape - shape[known].mean(axis=0)
    axes = np.linalg.svd(centred[known], full_matrices=False)[2]
    axes[2] *= np.sign(np.linalg.det(axes))
    return np.asarray(centred @ axes.T)


def _alike(first: NDArray[np.float64], second: NDArray[np.float64]) -> bool:
    return bool(
        np.nanmax(np.abs(first - second)) <= _TOLERANCE * np.nanmax(np.nanstd(second, axis=0))
    )


def _median_and_motion(
    aligned: NDArray[np.float64], shape: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the median shape, as before where no aligned frame has a marker; and the motion."""
    seen = ~np.isnan(aligned[..., 0]).all(axis=0)  # where numpy would warn of an empty median
    median, motion = shape.copy(), np.full(len(shape), np.inf)
    median[seen] = np.nanmedian(aligned[:, seen], axis=0)
    away = np.linalg.norm(aligned[:, seen] - median[seen], axis=2)
    motion[seen] = np.nanpercentile(away, _HIGH, axis=0)
    return median, motion
