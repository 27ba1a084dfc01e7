"""The pose of a head as six numbers per frame, and the difference of two poses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap import HeadMotion

if TYPE_CHECKING:
    from numpy.typing import NDArray

NAMES = ("turn x", "turn y", "turn z", "shift x", "shift y", "shift z")
"""Names of the numbers of `pose`: the rotation vector and the translation."""


def pose(motion: HeadMotion) -> NDArray[np.float64]:
    """Return (T, 6): the rotation vector in degrees, from the mean rotation, and mm.

    A rotation vector jumps where a turn passes half a circle; from the mean rotation, heads do not
    turn so far, however the recording lies in space.

    Raises
    ------
    ValueError
        If a rotation is a mirror image.
    """
    from scipy.spatial.transform import Rotation

    if not motion.frames:
        return np.empty((0, len(NAMES)))
    check_proper("head motion", motion)
    rotations = Rotation.from_matrix(motion.rotations)
    turned = (rotations * rotations.mean().inv()).as_rotvec(degrees=True)
    return np.concatenate([turned, motion.translations], axis=1)


def degrees_apart(first: HeadMotion, second: HeadMotion) -> NDArray[np.float64]:
    """Return (T,) degrees of the turn that leads from one rotation to the other."""
    product = first.rotations @ second.rotations.transpose(0, 2, 1)
    # The arc cosine of the trace alone loses what is below a ten-thousandth of a degree.
    axis = np.stack([product[:, i, j] - product[:, j, i] for i, j in ((2, 1), (0, 2), (1, 0))])
    cosine = np.trace(product, axis1=1, axis2=2) - 1.0
    return np.asarray(np.degrees(np.arctan2(np.linalg.norm(axis, axis=0), cosine)))


def left_over(motion: HeadMotion, removed: HeadMotion) -> HeadMotion:
    """Return the head motion that is left in what an alignment has made.

    With ``captured = M aligned`` of the true motion M and ``captured = N made`` of the removed
    one, ``made = N^-1 M aligned``.
    """
    back = removed.rotations.transpose(0, 2, 1)
    shift = (motion.translations - removed.translations)[..., None]
    return HeadMotion(
        rotations=back @ motion.rotations,
        translations=(back @ shift)[..., 0] / removed.scales[:, None],
        scales=motion.scales / removed.scales,
    )


def carried(positions: NDArray[np.float64], motion: HeadMotion) -> NDArray[np.float64]:
    """Return (n, M, 3): where the head carries its mean shape, the face being still.

    Parameters
    ----------
    positions
        (n, M, 3) with the head motion.
    motion
        The motion of the same n frames.
    """
    scale, shift = motion.scales[:, None, None], motion.translations[:, None]
    still = (positions - shift) @ motion.rotations / scale
    mean = still.sum(axis=0) / max(len(still), 1)
    return np.asarray(scale * (mean @ motion.rotations.transpose(0, 2, 1)) + shift)


def check_proper(what: str, motion: HeadMotion) -> None:
    """Raise a ValueError if a rotation is a mirror image."""
    mirrored = np.linalg.det(motion.rotations) < 0
    if mirrored.any():
        raise ValueError(
            f"{what}, frame {int(np.argmax(mirrored))}: the rotation is a mirror image "
            f"({np.count_nonzero(mirrored)} of {motion.frames} frames); align without reflection"
        )
