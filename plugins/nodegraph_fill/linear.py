"""A straight line across each gap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_fill.along_time import along_time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps


@along_time("fill.linear")
def linear(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    """Fill each gap with a straight line between its two ends.

    A gap of L frames after frame a, ended by frame b = a + L + 1, gets at its j-th frame
    ``P(a) + (P(b) - P(a)) j / (L + 1)``: what `numpy.interp` gives per marker and coordinate.
    The line looks ahead to the gap's end, up to L frames.
    """
    gap, _, _, share = gaps.samples
    before = positions[gaps.start - 1, gaps.marker]
    after = positions[gaps.stop, gaps.marker]
    return np.asarray(before[gap] + (after - before)[gap] * share[:, None])
