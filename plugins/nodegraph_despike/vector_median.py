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

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap import Trajectories

Reach = Annotated[int, Field(ge=1), Unit("frames")]


def running_median(
    recording: Trajectories, reach: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the vector median of each sample's window.

    Parameters
    ----------
    recording
        T frames of M markers.
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
    medians = median_kernel.medians(_contiguous(recording), _within(reach, recording))
    return medians


def running_spread(
    recording: Trajectories, median: NDArray[np.float64], reach: int
) -> NDArray[np.float64]:
    """Return the median of the distances from the samples of each window to its vector median.

    Parameters
    ----------
    recording
        T frames of M markers.
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
    spread = median_kernel.spreads(_contiguous(recording), median, _within(reach, recording))
    return spread


def _contiguous(recording: Trajectories) -> NDArray[np.float64]:
    return np.ascontiguousarray(recording.positions)


def _within(reach: int, recording: Trajectories) -> int:
    """Return a reach that is not beyond the take, where the window is the same as the take."""
    return min(reach, recording.frames)
