"""An animation's numbers as a player of GLB files needs them: none missing, quaternions smooth."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.animation import Animation


def held_weights(animation: Animation) -> NDArray[np.float64]:
    """Return (T, K) weights of the head's morph targets; a missing one repeats the last known.

    Before the first known weight it is the first, and 0 for a shape without any. A warning counts
    them.
    """
    weights = animation.morph_weights
    known = ~np.isnan(weights)
    if known.all():
        return weights
    frames = np.arange(len(weights))[:, None]
    last = np.maximum.accumulate(np.where(known, frames, -1), axis=0)
    source = np.where(last < 0, known.argmax(axis=0), last)
    held = np.nan_to_num(np.take_along_axis(weights, source, axis=0))
    never = np.asarray(~known.any(axis=0))
    _tell(animation, known, never)
    return held


def quaternions(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (T, 4) quaternions x, y, z, w of (T, 3, 3) rotations.

    Of the two that stand for one rotation it is the one nearer to the frame before, so that a
    player which blends frames takes the short way.

    Raises
    ------
    ValueError
        If one is a reflection, with its frame.
    """
    from scipy.spatial.transform import Rotation

    reflected = np.linalg.det(rotations) < 0
    if reflected.any():
        frame = int(np.argmax(reflected))
        raise ValueError(
            f"head motion: frame {frame} is a reflection ({np.count_nonzero(reflected)} such "
            "frames), and a GLB file holds rotations only"
        )
    found = Rotation.from_matrix(rotations).as_quat()
    nearer = np.where(np.einsum("ti,ti->t", found[1:], found[:-1]) < 0, -1.0, 1.0)
    return np.asarray(found * np.cumprod([1.0, *nearer])[:, None])


def _tell(animation: Animation, known: NDArray[np.bool_], never: NDArray[np.bool_]) -> None:
    frame, shape = (int(index) for index in np.argwhere(~known)[0])
    names = [name for name, absent in zip(animation.head.names, never, strict=True) if absent]
    nowhere = f"; {', '.join(names)} have none at all and stay 0" if names else ""
    warnings.warn(
        f"{np.count_nonzero(~known)} weights in {np.count_nonzero(~known.all(axis=1))} frames are "
        f"missing, and repeat the last known one, or the first that follows; the earliest is "
        f"{animation.head.names[shape]!r} in frame {frame}{nowhere}",
        stacklevel=4,
    )
