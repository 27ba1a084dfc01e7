"""The running median, where a sample lies farther from it than a face moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_despike.repair import Repairing, repaired, window_form
from nodegraph_despike.vector_median import Reach, reach_of, running_median
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


def _repair(positions: NDArray[np.float64], reach: int, threshold: float) -> NDArray[np.float64]:
    middle, distance = running_median(positions, reach)
    bad = distance > threshold
    return np.where(bad[..., None], middle, positions)


@node(
    "despike.median",
    cite="astola1990",
    adapted="from Astola et al. 1990: only samples beyond a threshold are replaced",
    lookahead=reach_of,
    live=window_form(_repair),
    shares=Repairing,
)
def median(
    repairing: Repairing,
    *,
    reach: Reach = 2,
    threshold: Annotated[float, Field(ge=0.0, allow_inf_nan=False), Unit("mm")] = 2.0,
) -> Trajectories:
    """Repair samples that lie farther from their window's median than a threshold.

    With m the vector median of the samples of frames ``i - reach .. i + reach``, the sample
    ``P_i`` is bad when ``|P_i - m| > threshold`` and is put at m, which is a sample of its
    window. A plain running median would replace every sample; with a threshold in millimetres
    only outliers are, and the rest of the trajectory stays bit for bit. `threshold` 0 is the
    plain one.

    The vector median (Astola et al.) is the sample with the smallest sum of distances to the
    others, so that nothing depends on how the axes lie; of equal sums, to one part in 10^9, the
    nearest in time, then the earlier one. Missing samples are left out of the window, which is
    cut off at the take's ends; a sample that has none before or none after it in its window is
    not judged. Impulses of up to `reach` frames are found. How many samples were repaired, and
    by how much, is in a warning; what an earlier method has filled or repaired counts as
    present.

    Looks ahead `reach` frames.

    Parameters
    ----------
    reach
        Frames on each side of a sample: the window has 2 reach + 1.
    threshold
        How far from the median a sample is bad. In the middle of steady motion a sample is the
        median itself, however fast; at turning points and in circles it is not.
    """
    recording = repairing.recording
    return repaired(recording, _repair(recording.positions, reach, threshold))
