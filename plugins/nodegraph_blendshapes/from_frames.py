"""A model from frames in which the face shows one expression each."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field

from nodegraph import Unit, node
from nodegraph_blendshapes.model import with_neutral
from nodegraph_blendshapes.rest_pose import pose_at_rest, whole_frame
from nodegraph_mocap import BlendshapeModel, Trajectories
from nodegraph_mocap.face_model import ModelAndNeutral
from nodegraph_mocap.shape_names import matched

Frame = Annotated[int, Field(ge=0)]


@node("blendshapes.from_frames", cite=("curio2006", "lewis2014"))
def from_frames(
    recording: Trajectories,
    neutral: Trajectories | None = None,
    *,
    frames: Annotated[dict[str, Frame], Field(min_length=1), Unit("frame")],
    neutral_frame: Annotated[int, Field(ge=0), Unit("frame")] = 0,
) -> ModelAndNeutral:
    """Build a model from chosen frames: each becomes a shape, its offset from the neutral.

    ``shape = P[frame] - neutral``, so that weight 1 is the expression as it was performed [1]_
    [2]_. Head motion must have been removed, or it is part of the shapes. A warning names shapes
    that are the same, or that move no marker.

    Parameters
    ----------
    recording
        Aligned, without missing samples in the chosen frames.
    neutral
        A recording of the face at rest, aligned alike, with the markers of `recording`; others
        are left out, with a warning. By default `recording` itself.
    frames
        Frame of each shape by its name: ``{smile: 120, jawOpen: 305}``, counted from 0. The
        shapes come in this order.
    neutral_frame
        The frame in which the face is at rest: of `neutral`, or of `recording` where no `neutral`
        is fed.

    Returns
    -------
    model : BlendshapeModel
        At the recording's markers.
    neutral : Trajectories
        The model's face at rest: one frame, its rate set to 1 Hz, with the recording's marker set.

    Raises
    ------
    Refusal
        If a marker is missing in one of the frames, with the frame and the markers.
    ValueError
        If there is no such frame, `neutral` lacks a marker of the recording, or two names mean the
        same shape (``jawOpen`` and ``jaw_open``).

    References
    ----------
    .. [1] C. Curio et al., Semantic 3D motion retargeting for facial animation, APGV '06, 77-84.
    .. [2] J. P. Lewis et al., Practice and theory of blendshape facial models, Eurographics 2014,
       State of the Art Reports, 199-218.
    """
    _check_distinct(tuple(frames))
    rest = recording if neutral is None else neutral
    at_rest = pose_at_rest(rest, neutral_frame, recording)
    poses = [whole_frame(recording, frame, f"shape {name!r}") for name, frame in frames.items()]
    model = BlendshapeModel(
        neutral=at_rest,
        shapes=np.array(poses) - at_rest,
        names=tuple(frames),
        markers=recording.markers,
    )
    return with_neutral(model, recording.marker_set)


def _check_distinct(names: tuple[str, ...]) -> None:
    for place, name in enumerate(names):
        same = matched([name], names[:place]).get(name)
        if same is not None:
            raise ValueError(f"shapes {same!r} and {name!r} have the same name; rename one")
