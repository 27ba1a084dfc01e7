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
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
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
    spread : (T, M) array of float64
        The median of the distances from the window's samples to it; infinite where not judged.
    """
    from nodegraph_despike import median_kernel

    # A window longer than the take is the whole take; a reach beyond it would only overflow.
    reach = min(reach, recording.frames)
    place, spread = median_kernel.medians(np.ascontiguousarray(recording.positions), reach)
    median = np.take_along_axis(recording.positions, place[..., None], axis=0)
    distance = np.linalg.norm(recording.positions - median, axis=2)
    return median, distance, spread
