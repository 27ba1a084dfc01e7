"""The pose at rest, and other frames that become shapes: every marker must be present."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Refusal, listed
from nodegraph_mocap import Trajectories, check_markers

if TYPE_CHECKING:
    from numpy.typing import NDArray


def whole_frame(recording: Trajectories, frame: int, what: str) -> NDArray[np.float64]:
    """Return (M, 3) positions of a frame.

    Parameters
    ----------
    recording
    frame
    what
        Its purpose, for messages: ``the neutral``, ``shape 'smile'``.

    Raises
    ------
    Refusal
        If a marker is missing there.
    ValueError
        If the recording has no such frame.
    """
    if not 0 <= frame < recording.frames:
        last = f"0 to {recording.frames - 1}" if recording.frames else "none"
        raise ValueError(f"{what}: there is no frame {frame}; there are {last}")
    lacking = [
        name
        for name, there in zip(recording.markers, recording.present[frame], strict=True)
        if not there
    ]
    if lacking:
        raise Refusal(
            f"{what}: frame {frame} lacks {len(lacking)} of {len(recording.markers)} markers "
            f"({listed(lacking)}); fill the recording first, or take another frame"
        )
    return np.asarray(recording.positions[frame])


def pose_at_rest(neutral: Trajectories, frame: int, recording: Trajectories) -> NDArray[np.float64]:
    """Return (M, 3) positions of the recording's markers in a frame of another one.

    Raises
    ------
    Refusal
        If one of them is missing there.
    ValueError
        If `neutral` lacks a marker of the recording, or has no such frame.
    """
    check_markers(neutral, recording.markers, what="the neutral")
    spare = [name for name in neutral.markers if name not in recording.markers]
    if spare:
        warnings.warn(
            f"{len(spare)} markers of the neutral are not in the recording, and are left out: "
            f"{listed(spare)}",
            stacklevel=3,
        )
    return whole_frame(neutral.keep(recording.markers), frame, "the neutral")
