"""A straight line across each gap."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import node
from nodegraph_fill.gaps import LONG, NEVER, Gaps, MaxGap, warn_left
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node("fill.linear")
def linear(recording: Trajectories, *, max_gap: MaxGap = None) -> Trajectories:
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
    max_gap
        Gaps longer than this stay missing; none: gaps of any length are filled. A gap is a run
        of missing samples of one marker.

    Returns
    -------
    Trajectories
        The recording with filled samples, their origin `Origin.FILLED`.
    """
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
    bridged = gaps.chosen(gaps.inner & ~long)
    filled = recording.with_samples(
        _bridge(recording, bridged), changed=bridged.mask, origin=Origin.FILLED
    )
    reasons = [
        (gaps.chosen(gaps.never), NEVER),
        (gaps.chosen(long), LONG),
        (gaps.chosen(gaps.at_start & ~long), "at the take's start"),
    ]
    warn_left(filled, reasons, "at the take's end", stacklevel=2)
    return filled


def _bridge(recording: Trajectories, gaps: Gaps) -> NDArray[np.float64]:
    positions = recording.positions.copy()
    gap, frame, marker, share = gaps.samples
    before = positions[gaps.start - 1, gaps.marker]
    after = positions[gaps.stop, gaps.marker]
    positions[frame, marker] = before[gap] + (after - before)[gap] * share[:, None]
    return positions
