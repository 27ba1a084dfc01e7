"""The ports and settings of alignments to a reference."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

from nodegraph_align.landmarks import Landmarks
from nodegraph_align.poses import Scale
from nodegraph_mocap import Trajectories


@dataclass(frozen=True)
class Faces:
    """A recording and the face that it is aligned to.

    Attributes
    ----------
    recording
        Trajectories, with or without gaps.
    reference
        The face to align to: its first frame that has all landmarks, else its fullest frame with
        the landmarks of that one. Left open: the recording's first frame that has all landmarks.
    landmarks
        Names of markers that the fit goes by. None: the stable markers of the recording's marker
        set, or of the reference's if that names none. ``*`` alone: all markers that both have.
    scale
        none: the head keeps its size. rms: as large as the reference by the root mean square
        distance from their mean of the landmarks, as they are weighted. least_squares: as fits
        best.

    Returns
    -------
    aligned : Trajectories
        The recording, each frame moved; gaps, `origin` and marker set as they were, `sigma`
        scaled.
    head_motion : HeadMotion
        ``captured = s R aligned + t``.
    reference : Trajectories
        The frame that was aligned to.

    Raises
    ------
    ValueError
        If a landmark is unknown (the message names the nearest), listed twice, or there are fewer
        than three; if none are named and no marker set says which markers are stable; if a
        setting is out of range.
    Refusal
        If no reference is given and no frame has all landmarks; if the reference's landmarks are
        fewer than three, on a line or in one place; if no frame has three that are not on a line.
    """

    recording: Trajectories
    reference: Trajectories | None = None
    _: KW_ONLY
    landmarks: Landmarks | None = None
    scale: Scale = "none"
