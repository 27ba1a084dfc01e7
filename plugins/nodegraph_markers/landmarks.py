"""The few markers that move least, as landmarks of the head."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_SHARE, _FEWEST = 6, 3
_FLAT = 0.1
"""Extent across a line, to that along it, below which points count as on the line."""


def still_landmarks(
    shape: NDArray[np.float64], motion: NDArray[np.float64], partner: NDArray[np.intp]
) -> list[int]:
    """Return which markers move least: a sixth of them, three at least, not all on a line.

    A pair counts with the motion of the marker that moves more, and comes as a whole. While the
    landmarks lie on a line, the next one is added.

    Parameters
    ----------
    shape
        (N, 3) mm.
    motion
        (N,) mm.
    partner
        (N,), the number of each marker's partner, or -1.

    Returns
    -------
    list of int
        In rising order.
    """
    paired = np.where(partner < 0, np.arange(len(shape)), partner)
    together = np.maximum(motion, motion[paired])
    order = np.argsort(together, kind="stable")
    count = max(_FEWEST, len(shape) // _SHARE)
    while count < len(order) and (
        together[order[count]] == together[order[count - 1]] or _on_a_line(shape[order[:count]])
    ):
        count += 1
    return sorted(order[:count].tolist())


def _on_a_line(points: NDArray[np.float64]) -> bool:
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(extents[1] < _FLAT * extents[0])
