"""Parts of a take."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories

Frame = Annotated[int, Field(ge=0), Unit("frame")]
Span = tuple[Frame, Frame | None]
Spans = Annotated[tuple[Span, ...], Field(min_length=1, examples=[((0, 9), (5, None))])]


def _ranges(recording: Trajectories, frames: Spans) -> list[range]:
    """Return the frames that are kept, or refuse frames that the take does not have."""
    ranges: list[range] = []
    for first, last in frames:
        end = recording.frames - 1 if last is None else last
        if max(first, end) >= recording.frames:
            raise ValueError(
                f"frames {first} to {end} do not exist; the take has {recording.frames} frames, "
                f"0 to {recording.frames - 1}"
            )
        if end < first:
            raise ValueError(f"the last frame, {end}, comes before the first, {first}")
        ranges.append(range(first, end + 1))
    return ranges


@node("recording.crop", requires=_ranges)
def crop(recording: Trajectories, *, frames: Spans) -> Trajectories:
    """Cut one or several parts out of a take.

    Parameters
    ----------
    recording
        Trajectories, T frames.
    frames
        The first and the last frame of each part, both kept; frames are counted from 0, and no
        last one (``null``) is the take's. ``[[450, 849], [1050, null]]`` puts two parts one after
        another, as if the camera had run on.

    Returns
    -------
    Trajectories
        ``last - first + 1`` frames of each part.

    Raises
    ------
    ValueError
        If the take has no such frames, or a part's last comes before its first.
    """
    return recording[np.concatenate(_ranges(recording, frames))]
