"""The loop that reads the markers of a packet, compiled: import this module only when it runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel("positions", "origin")
def read_markers(
    numbers: NDArray[np.floating],
    zeros_missing: bool,
    farthest: float,
    positions: NDArray[np.float64],
    origin: NDArray[np.uint8],
    missing: int,
    measured: int,
) -> bool:
    """Write positions and their origin; return whether none is too far away.

    Parameters
    ----------
    numbers : (M, 3) array of float32 or float64
        A marker is missing if a coordinate is NaN.
    zeros_missing
        Whether a marker at exactly (0, 0, 0) is missing too.
    farthest
    positions : (M, 3) array of float64
        Written: the numbers; NaN where a marker is missing.
    origin : (M,) array of uint8
        Written: what is `missing` or `measured`.
    missing, measured
    """
    is_near = True
    for marker in range(len(numbers)):
        x, y, z = numbers[marker]
        zero = x == 0 and y == 0 and z == 0
        there = x == x and y == y and z == z and not (zeros_missing and zero)
        origin[marker] = measured if there else missing
        for axis in range(3):
            number = numbers[marker, axis] if there else np.nan
            positions[marker, axis] = number
            is_near &= not abs(number) > farthest
    return is_near
