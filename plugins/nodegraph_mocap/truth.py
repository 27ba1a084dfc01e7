"""The truth of a recording that a node damages."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.recording import Trajectories


def truth_of(
    recording: Trajectories,
    truth: Trajectories | None,
    damaged: NDArray[np.bool_] | None = None,
) -> Trajectories:
    """Return what errors are measured to: `truth`, or the recording itself where there is none.

    Parameters
    ----------
    recording
        The recording that is damaged.
    truth
        The same frames and markers without noise, in any order of the markers.
    damaged
        (T, M), the samples that the truth must have; None if it may lack any.

    Raises
    ------
    ValueError
        If the truth has another rate, other frames or other markers, or lacks a damaged sample.
    """
    if truth is None:
        return recording
    for what, unit in (("frames", "frames"), ("rate", "Hz")):
        ours, theirs = getattr(recording, what), getattr(truth, what)
        if ours != theirs:
            raise ValueError(f"truth has {theirs:g} {unit}, the recording {ours:g}")
    lacks = [name for name in recording.markers if name not in set(truth.markers)]
    adds = [name for name in truth.markers if name not in set(recording.markers)]
    if lacks or adds:
        lists = (("lacks", lacks), ("has besides", adds))
        differences = "; ".join(f"{verb} {listed(names)}" for verb, names in lists if names)
        raise ValueError(f"truth and recording differ in their markers: truth {differences}")
    if damaged is not None:
        columns = [truth.markers.index(name) for name in recording.markers]
        unknown = np.argwhere(damaged & ~truth.present[:, columns])
        if len(unknown):
            frame, marker = unknown[0]
            raise ValueError(
                f"frame {frame}, marker {recording.markers[marker]!r}: the truth has no sample "
                f"there, where the recording's is to be damaged ({len(unknown)} such samples); "
                "errors cannot be measured to it"
            )
    return truth
