"""The nearest marker's trajectory, bent to meet both ends of the gap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.along_time import along_time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps


@along_time(
    "fill.pattern",
    cite="vicon_nexus",
    adapted="from Vicon Nexus: the donor is the nearest marker, not one that the user picks",
    otherwise="no marker without a hole there",
)
def pattern(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    """Fill each gap with the movement of the nearest marker, bent to meet both ends (Vicon).

    With the donor's trajectory D(t), the gap in F between the frames a and b, and the straight
    line through a trajectory's samples at the ends,
    ``V(G, t) = G(a) + (G(b) - G(a)) (t - a) / (b - a)``, the fill is
    ``F(t) = V(F, t) + D(t) - V(D, t)``. The donor is the marker nearest to F at frame a among
    those that are present from a to b; equally near ones go by marker order.

    A gap for which there is no donor stays missing, counted in a warning.

    Looks ahead to the gap's end.
    """
    donor = _donors(positions, gaps)
    gap, frame, marker, share = gaps.samples
    share = share[:, None]
    first, last = gaps.start[gap] - 1, gaps.stop[gap]
    other = donor[gap]
    bend = (1.0 - share) * (positions[first, marker] - positions[first, other])
    bend += share * (positions[last, marker] - positions[last, other])
    return np.where(other[:, None] < 0, np.nan, positions[frame, other] + bend)


def _donors(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.intp]:
    """Return the nearest marker that has no hole in each gap; -1 where there is none."""
    missing = np.zeros((len(positions) + 1, positions.shape[1]), dtype=np.intp)
    np.cumsum(np.isnan(positions[..., 0]), axis=0, out=missing[1:])
    donor = np.full(len(gaps.start), -1)
    for index in range(len(donor)):
        first = gaps.start[index] - 1
        whole = missing[gaps.stop[index] + 1] == missing[first]
        if whole.any():
            here = positions[first]
            squared = ((here - here[gaps.marker[index]]) ** 2).sum(axis=1)
            donor[index] = np.where(whole, squared, np.inf).argmin()
    return donor
