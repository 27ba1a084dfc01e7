"""Head motion put back."""

from __future__ import annotations

from dataclasses import replace

from nodegraph import node
from nodegraph_align.poses import moved
from nodegraph_mocap import HeadMotion, Trajectories


@node("headmotion.restore")
def restore(recording: Trajectories, head_motion: HeadMotion) -> Trajectories:
    """Put the head motion back that an alignment took out: ``s R x + t`` in each frame.

    Looks ahead no frame.

    Parameters
    ----------
    recording
        A face without head motion, or whatever became of it.
    head_motion
        The head motion of as many frames.

    Returns
    -------
    Trajectories
        The recording, each frame moved; gaps, `origin` and marker set as they were, `sigma`
        scaled.

    Raises
    ------
    ValueError
        If the numbers of frames differ.
    """
    if recording.frames != head_motion.frames:
        raise ValueError(
            f"the recording has {recording.frames} frames, the head motion {head_motion.frames}: "
            "take the head motion of this recording, and crop or resample after restoring it"
        )
    matrices = head_motion.scales[:, None, None] * head_motion.rotations
    positions = moved(recording.positions, matrices, head_motion.translations)
    sigma = None if recording.sigma is None else recording.sigma * head_motion.scales[:, None]
    return replace(recording, positions=positions, sigma=sigma)
