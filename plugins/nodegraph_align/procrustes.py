"""Procrustes analysis of each frame, by landmarks that expression does not move."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal, get_args

import numpy as np
from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from nodegraph import Refusal, StateForm, node
from nodegraph_align.faces import Faces
from nodegraph_align.landmarks import FEWEST, Landmarks
from nodegraph_align.poses import (
    MIRRORED,
    Aligned,
    Scale,
    Transforms,
    fit,
    fitted,
    for_kernel,
    warn,
)
from nodegraph_align.reference import Reference, reference_of
from nodegraph_mocap import HeadMotion, HeadPose, MarkerFrame, Trajectories

if TYPE_CHECKING:
    from collections.abc import Sequence

Step = Literal["translate", "scale", "rotate"]
STEPS: tuple[Step, ...] = get_args(Step)


def _as_pydantic_says_it(steps: tuple[Step, ...]) -> tuple[Step, ...]:
    if steps != STEPS[: len(steps)]:
        raise PydanticCustomError("steps", f"Input should be the first ones of {', '.join(STEPS)}")
    return steps


Steps = Annotated[tuple[Step, ...], AfterValidator(_as_pydantic_says_it)]


class _Stream:
    """The alignment frame by frame, to a reference that is given."""

    def __init__(
        self,
        recording: Trajectories,
        reference: Trajectories | None = None,
        *,
        landmarks: Landmarks | None,
        steps: Steps,
        scale: Scale,
        restore: bool,
        reflection: bool,
    ) -> None:
        if reference is None:
            raise Refusal(
                "frame by frame, it needs a reference: its own is the first frame of the take "
                "that has all landmarks"
            )
        self._onto, _ = reference_of(recording, reference, landmarks)
        columns = self._onto.columns(recording)
        alike = np.ones((1, len(columns)))
        self._places = for_kernel(columns), for_kernel(self._onto.shape), for_kernel(alike)
        self._steps, self._scale = tuple(steps), scale
        self._restore, self._reflection = restore, reflection
        self.header = (recording, HeadMotion.still(0), None)

    def push(self, frame: MarkerFrame) -> tuple[MarkerFrame, HeadPose, None]:
        positions = frame.positions[None]
        sigma = None if frame.sigma is None else frame.sigma[None]
        poses = fit(positions, *self._places, self._scale, reflection=self._reflection)
        poses, _ = _wanted(poses, self._onto, self._steps, self._scale, restore=self._restore)
        if poses.states[0] > MIRRORED:
            warnings.warn(
                f"a frame stays as it is, with fewer than {FEWEST} landmarks or all on a line",
                stacklevel=2,
            )
        there = poses.moved(positions, sigma)
        return (
            MarkerFrame(
                there.positions[0],
                frame.origin.copy(),
                None if there.sigma is None else there.sigma[0],
            ),
            HeadPose(there.rotations[0], there.translations[0], there.scales[0]),
            None,
        )

    def drain(self) -> Iterable[object]:
        return ()


@node(
    "align.procrustes",
    cite=("krzanowski2000", "kabsch1978"),
    lookahead=0,
    live=StateForm(_Stream, outputs=("aligned", "head_motion")),
    shares=Faces,
)
def procrustes(
    faces: Faces,
    *,
    steps: Steps = STEPS,
    restore: bool = True,
    reflection: bool = False,
) -> Aligned:
    """Align each frame to a reference by landmarks, and return the head motion that this undoes.

    A frame's landmarks ``x_i`` and the reference's ``y_i``, those of the n landmarks that the
    frame has, give what all of the frame's points go through, in up to three steps:

    - translate: their means come to lie in one place, ``x - mean(x_i) + mean(y_i)``;
    - scale: with `scale` rms the root mean square distances ``sqrt(sum(|x_i - mean(x_i)|^2) / n)``
      become the same (eq 2);
    - rotate: by R = ``U diag(1, 1, det(U V^T)) V^T`` of ``M = sum(y_i x_i^T) = U S V^T`` with
      points as columns, centred (eqs 3-6). The sign makes R a rotation; without it three noisy
      landmarks give a mirror image half of the time.

    Markers are matched by name. A frame that has some of the landmarks is aligned by these; with
    fewer than three, or with all on a line (second singular value of M below 1/1000 of the first),
    it stays as it is. Both are counted in a warning, and so are frames that fit badly where their
    mirror image would fit well. Points in a plane (z = 0) are points in space: their mirror image
    is the same shape turned over.

    Weights of a blendshape model are those of a face aligned to the model's neutral, not to a
    recording's own first frame. Looks ahead no frame; frame by frame, a reference must be given.

    Parameters
    ----------
    steps
        The steps that are carried out, the first ones of translate, scale, rotate; none of them
        leaves all as it is.
    scale
        none: the head keeps its size. rms: as large as the reference, by equation 2.
        least_squares: the scale that with the rotation fits best,
        ``trace(diag(1, 1, det) S) / sum(|x_i - mean(x_i)|^2)``, at every prefix of the steps.
    restore
        True: in the reference's place and millimetres, and the reference stays as it is. False:
        as the steps leave it, with the reference's landmarks about the origin, and after a scale
        step with the reference's root mean square distance as the unit of length.
    reflection
        Whether a mirror image may be chosen where it fits better.

    Returns
    -------
    head_motion : HeadMotion
        ``captured = s R aligned + t``, also for some of the steps and where nothing is restored.
    reference : Trajectories
        The frame that was aligned to, with what the steps do to it.

    Raises
    ------
    ValueError
        If a landmark is unknown (the message names the nearest), listed twice, or there are fewer
        than three; if none are named and no marker set says which markers are stable; if steps
        are not the first ones of translate, scale, rotate.
    """
    requested = tuple(steps)
    if requested != STEPS[: len(requested)]:
        raise ValueError(
            f"steps must be the first ones of {', '.join(STEPS)}, got {', '.join(requested)}"
        )
    recording = faces.recording
    onto, notes = reference_of(recording, faces.reference, faces.landmarks)
    poses = fitted(recording, onto, faces.scale, reflection=reflection)
    warn(poses, recording, onto, notes, stacklevel=4)
    poses, target = _wanted(poses, onto, requested, faces.scale, restore=restore)
    return Aligned(*poses.move(recording), target)


def _wanted(
    poses: Transforms, onto: Reference, steps: Steps, scale: Scale, *, restore: bool
) -> tuple[Transforms, Trajectories]:
    """Return the poses with the steps that are carried out, and the reference after these."""
    poses = _carried_out(poses, steps, scale)
    if restore or not steps:
        return poses, onto.frame
    unit = onto.size if "scale" in steps and scale != "none" else 1.0
    return _about_the_origin(poses, onto, unit)


def _carried_out(poses: Transforms, steps: Sequence[Step], scale: Scale) -> Transforms:
    """Return the poses without the steps that are left out."""
    if not steps:
        still = np.zeros_like(poses.goals)
        poses = poses._replace(centres=still, goals=still)
    if "scale" not in steps:
        poses = poses._replace(scales=np.ones_like(poses.scales))
    if "rotate" not in steps:
        poses = poses._replace(rotations=np.tile(np.eye(3), (len(poses.scales), 1, 1)))
    return poses


def _about_the_origin(
    poses: Transforms, reference: Reference, unit: float
) -> tuple[Transforms, Trajectories]:
    """Return poses and reference with the landmarks' mean at the origin, in another unit."""
    moved = poses._replace(
        scales=poses.scales / unit, goals=(poses.goals - reference.centre) / unit
    )
    frame = reference.frame
    sigma = None if frame.sigma is None else frame.sigma / unit
    positions = (frame.positions - reference.centre) / unit
    return moved, replace(frame, positions=positions, sigma=sigma)
