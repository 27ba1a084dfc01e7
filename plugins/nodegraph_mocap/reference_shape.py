"""The markers' places relative to one another in one pose, as far as a recording shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.recording import Trajectories


def reference_shape(recording: Trajectories) -> NDArray[np.float64]:
    """Return the markers' positions in the recording's most complete frame.

    A marker that is missing there comes from the frame that shares the most markers with it,
    moved rigidly onto the markers that both frames have (by translation alone where they share
    fewer than three). Ties go to the earlier frame.

    Parameters
    ----------
    recording
        Any recording, with or without gaps.

    Returns
    -------
    (M, 3) array of float64
        Millimetres; NaN for a marker that is never present.
    """
    shape = np.full((len(recording.markers), 3), np.nan)
    present = recording.present
    if not present.any():
        return shape
    frame = int(np.argmax(present.sum(axis=1)))
    there = present[frame]
    shape[:] = recording.positions[frame]
    shared = (present & there).sum(axis=1) + 1
    for marker in np.flatnonzero(~there & present.any(axis=0)):
        donor = int(np.argmax(shared * present[:, marker]))
        both = present[donor] & there
        pose = recording.positions[donor]
        shape[marker] = _moved(pose[marker], pose[both], recording.positions[frame][both])
    return shape


def _moved(
    point: NDArray[np.float64], source: NDArray[np.float64], target: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the point as the rigid motion that best takes source to target moves it."""
    if not len(source):
        return point
    middle, goal = source.mean(axis=0), target.mean(axis=0)
    if len(source) < 3:
        return np.asarray(point - middle + goal)
    u, _, v = np.linalg.svd((source - middle).T @ (target - goal))
    u[:, 2] *= np.sign(np.linalg.det(u @ v))
    return np.asarray((point - middle) @ u @ v + goal)
