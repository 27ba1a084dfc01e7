"""The Hampel filter: far from the window's median, measured by the window's own spread."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import node
from nodegraph_despike.repair import Repairing, repaired, window_form
from nodegraph_despike.vector_median import Reach, reach_of, running_median, running_spread
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_NORMAL = 1.4826
"""The standard deviation of a normal variable over its median absolute deviation."""


def _repair(positions: NDArray[np.float64], reach: int, threshold: float) -> NDArray[np.float64]:
    median, distance = running_median(positions, reach)
    spread = running_spread(positions, median, reach)
    judged = np.isfinite(spread)
    bar = threshold * _NORMAL * np.where(judged, spread, 0.0)
    bad = judged & (distance > bar)
    return np.where(bad[..., None], median, positions)


@node(
    "despike.hampel",
    cite=("pearson2016", "astola1990"),
    adapted=(
        "from Pearson et al. 2016: the vector median and Euclidean lengths take the place of "
        "the median and absolute values"
    ),
    lookahead=reach_of,
    live=window_form(_repair),
    shares=Repairing,
)
def hampel(
    repairing: Repairing,
    *,
    reach: Reach = 3,
    threshold: Annotated[float, Field(ge=0.0, allow_inf_nan=False)] = 3.0,
) -> Trajectories:
    """Repair samples that lie far from their window's median, by the window's spread (Hampel).

    The Hampel filter as Pearson et al. give it, with Euclidean lengths for absolute values: with
    m the vector median of the samples of frames ``i - reach .. i + reach`` and
    ``S = 1.4826 median_j |P_j - m|``, the sample ``P_i`` is bad when ``|P_i - m| > threshold S``
    and is put at m, which is a sample of its window. For movement along a line that is the
    filter in one dimension; for noise in space S is 2.28 times its standard deviation per
    coordinate. Where more than half of the window lies in one place, S = 0 and any other sample
    is bad; in the middle of steady motion the sample is the median itself, and never bad.

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
        How many times S away a sample is bad; 0 puts every sample at its median.
    """
    recording = repairing.recording
    return repaired(recording, _repair(recording.positions, reach, threshold))
