"""A straight line across each gap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import node
from nodegraph_fill.along_time import bridge
from nodegraph_fill.gaps import Gaps, MaxGap, to_gap_end
from nodegraph_fill.meet_ends import Ends
from nodegraph_fill.streams import live_form
from nodegraph_mocap import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


def _straight(positions: NDArray[np.float64], gaps: Gaps) -> NDArray[np.float64]:
    gap, _, _, share = gaps.samples
    before = positions[gaps.start - 1, gaps.marker]
    after = positions[gaps.stop, gaps.marker]
    return np.asarray(before[gap] + (after - before)[gap] * share[:, None])


@node(
    "fill.linear",
    lookahead=to_gap_end,
    ends=True,
    live=live_form(lambda: _straight),
)
def linear(
    recording: Trajectories, *, ends: Ends = "as_published", max_gap: MaxGap = None
) -> Trajectories:
    """Fill each gap with a straight line between its two ends.

    A gap of L frames after frame a, ended by frame b = a + L + 1, gets at its j-th frame
    ``P(a) + (P(b) - P(a)) j / (L + 1)``: what `numpy.interp` gives per marker and coordinate.
    The line looks ahead to the gap's end, up to L frames.

    A gap at the start or at the end of the take has one end only and stays missing, counted in
    a warning, as does a marker that is never measured. Samples that are present come out as
    they went in; those that an earlier fill has made count as ends like measured ones.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    ends
        No matter: the fill meets both ends by itself.
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """
    return bridge(recording, ends, max_gap, _straight)
