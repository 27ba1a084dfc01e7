"""Part of a take."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories

Frame = Annotated[int, Field(ge=0), Unit("frame")]


def _end(recording: Trajectories, first: int, last: int | None) -> int:
    """Return the last frame that is kept, or refuse frames that the take does not have."""
    end = recording.frames - 1 if last is None else last
    if max(first, end) >= recording.frames:
        raise ValueError(
            f"frames {first} to {end} do not exist; the take has {recording.frames} frames, "
            f"0 to {recording.frames - 1}"
        )
    if end < first:
        raise ValueError(f"the last frame, {end}, comes before the first, {first}")
    return end


@node("recording.crop", requires=_end)
def crop(recording: Trajectories, *, first: Frame = 0, last: Frame | None = None) -> Trajectories:
    """Cut a part out of a take.

    Parameters
    ----------
    recording
        Trajectories, T frames.
    first
        The first frame that is kept; frames are counted from 0.
    last
        The last frame that is kept, itself included; none: the take's last.

    Returns
    -------
    Trajectories
        ``last - first + 1`` frames.

    Raises
    ------
    ValueError
        If the take has no such frames, or `last` comes before `first`.
    """
    frames = slice(first, _end(recording, first, last) + 1)
    return replace(
        recording,
        positions=recording.positions[frames],
        origin=recording.origin[frames],
        sigma=None if recording.sigma is None else recording.sigma[frames],
    )
