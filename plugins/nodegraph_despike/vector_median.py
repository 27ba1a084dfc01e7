"""The running vector median, which does not depend on how the coordinate axes lie.

The vector median of the samples of a window is the one of them whose distances to the others
have the smallest sum (Astola, Haavisto and Neuvo); of equal sums (to one part in 10^9, so that
rounding does not choose) the nearest in time to the middle, then the earlier one. The window
holds the present samples among the `reach` frames on each side and the one in the middle; at
the ends of a take and at gaps it is what there is of it. A sample is judged when it is present
and its window has a sample before it and one after it: at an end, an impulse is no other than
a movement.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field

from nodegraph import Unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

Reach = Annotated[int, Field(ge=1), Unit("frames")]


def reach_of(settings: Mapping[str, Any]) -> int:
    """Return the look-ahead of a filter by a window."""
    return int(settings["reach"])


def running_median(
    positions: NDArray[np.float64], reach: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the vector median of each sample's window.

    Parameters
    ----------
    positions
        (T, M, 3) mm; NaN where missing.
    reach
        Frames on each side.

    Returns
    -------
    median : (T, M, 3) array of float64
        Millimetres; the sample itself where it is not judged.
    distance : (T, M) array of float64
        From the sample to it; 0 where it is not judged, NaN where missing.
    """
    from nodegraph_despike import median_kernel

    medians: tuple[NDArray[np.float64], NDArray[np.float64]]
    medians = median_kernel.medians(np.ascontiguousarray(positions), _within(reach, positions))
    return medians


def running_spread(
    positions: NDArray[np.float64], median: NDArray[np.float64], reach: int
) -> NDArray[np.float64]:
    """Return the median of the distances from the samples of each window to its vector median.

    Parameters
    ----------
    positions
        (T, M, 3) mm; NaN where missing.
    median
        (T, M, 3) mm, as from `running_median`.
    reach
        Frames on each side.

    Returns
    -------
    (T, M) array of float64
        Millimetres; infinite where the sample is not judged.
    """
    from nodegraph_despike import median_kernel

    spread: NDArray[np.float64]
    positions = np.ascontiguousarray(positions)
    spread = median_kernel.spreads(positions, median, _within(reach, positions))
    return spread


def _within(reach: int, positions: NDArray[np.float64]) -> int:
    """Return a reach that is not beyond the take, where the window is the same as the take."""
    return min(reach, len(positions))
