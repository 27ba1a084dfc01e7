"""The truth of a recording, which has its frames and markers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_mocap.recording import Mask, Trajectories


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
    check_same_samples("truth", truth, "recording", recording)
    if truth.rate != recording.rate:
        raise ValueError(f"truth has {truth.rate:g} Hz, the recording has {recording.rate:g} Hz")
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


def check_same_samples(
    what: str, given: Trajectories | Mask, other: str, recording: Trajectories
) -> None:
    """Raise a ValueError if a recording or mask has other frames or markers than a recording.

    Parameters
    ----------
    what, other
        The names of the two in messages.
    given, recording
        The two; their markers may be in any order.
    """
    if given.frames != recording.frames:
        raise ValueError(f"{what} has {given.frames} frames, the {other} has {recording.frames}")
    has, wanted = set(given.markers), set(recording.markers)
    if has != wanted:
        lacks = [name for name in recording.markers if name not in has]
        adds = [name for name in given.markers if name not in wanted]
        lists = (("lacks", lacks), ("has besides", adds))
        differences = "; ".join(f"{verb} {listed(names)}" for verb, names in lists if names)
        raise ValueError(f"{what} and {other} differ in their markers: {what} {differences}")
