"""The mean of several recordings."""

from __future__ import annotations

import numpy as np

from nodegraph import node
from nodegraph_combine.recording_stack import Several, stack_recordings
from nodegraph_mocap import Trajectories


@node("combine.mean", lookahead=0, shares=Several)
def mean(several: Several) -> Trajectories:
    """Take the mean of several recordings of one take, sample by sample.

    ``P[t, m] = sum(P_c[t, m]) / n`` over the n recordings that have the sample. What all of them
    have alike comes out bit for bit, and what none has stays missing. Markers are matched by
    name. Recordings that were refused or failed are named in a warning.

    Looks ahead 0 frames.
    """
    all_of_them = stack_recordings(several)
    there = ~np.isnan(all_of_them.positions)
    count = there.sum(axis=0)
    total = np.where(there, all_of_them.positions, 0.0).sum(axis=0)
    return all_of_them.with_samples(np.where(count > 0, total / np.maximum(count, 1), np.nan))
