"""The median of several recordings."""

from __future__ import annotations

import numpy as np

from nodegraph import node
from nodegraph_combine.recording_stack import Several, stack_recordings
from nodegraph_mocap import Trajectories


@node("combine.median", lookahead=0, shares=Several)
def median(several: Several) -> Trajectories:
    """Take the median of several recordings of one take, coordinate by coordinate.

    The middle value of each coordinate over the recordings that have the sample, the mean of
    the two middle ones where their number is even: one method that errs far does not count.
    Each coordinate by itself, the median depends on the axes: turned recordings give another.
    What all of them have alike comes out bit for bit, and what none has stays missing. Markers
    are matched by name. A warning names recordings that were
    refused or failed.

    Looks ahead 0 frames.
    """
    all_of_them = stack_recordings(several)
    # NaN sorts last, so that the middle of what is there can be picked by its count
    ordered = np.sort(all_of_them.positions, axis=0)
    count = (~np.isnan(ordered)).sum(axis=0)
    low, high = np.maximum(count - 1, 0) // 2, np.maximum(count, 1) // 2
    pair = [np.take_along_axis(ordered, rank[None], axis=0)[0] for rank in (low, high)]
    return all_of_them.with_samples((pair[0] + pair[1]) / 2.0)
