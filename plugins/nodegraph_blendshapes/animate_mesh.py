"""A head that moves as a face did."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from nodegraph import StateForm, node
from nodegraph_blendshapes.shape_matches import driving
from nodegraph_mocap import Animation, AnimationFrame, Head, HeadMotion, HeadPose, Weights
from nodegraph_mocap.shape_names import sides_as

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class _Stream:
    """The animation frame by frame."""

    def __init__(self, weights: Weights, head: Head, head_motion: HeadMotion | None = None) -> None:
        self.header = mesh(weights, head, head_motion)
        self._sides = sides_as(weights.names, head.names)
        self._columns = [self._sides.names.index(name) for name in self.header.weights.names]

    def push(self, weights: NDArray[np.float64], pose: HeadPose | None = None) -> AnimationFrame:
        return AnimationFrame(self._sides.of(weights)[self._columns], pose)

    def drain(self) -> Iterable[AnimationFrame]:
        return ()


@node(
    "animate.mesh",
    cite=("curio2006",),
    live=StateForm(_Stream, streams=("weights", "head_motion"), lookahead=0),
)
def mesh(weights: Weights, head: Head, head_motion: HeadMotion | None = None) -> Animation:
    """Animate a head's mesh by weights, which may come from another face.

    The morph targets of the head and the shapes whose weights were solved are parallel: what has
    the same name means the same expression, so the weights found on one face drive another [1]_.
    Names match across conventions (``EyeBlinkLeft``, ``eyeBlinkLeft``, ``eyeBlink_L``). A weight
    without sides, such as ``browInnerUp``, drives the morph targets of both sides where the head
    has these instead, and a morph target without sides gets the mean of the weights of both.
    Weights that the head has no morph target for are left out, and morph targets without weight
    stay at 0. Warnings count and name all of these. Missing weights (NaN) stay missing;
    ``write.glb`` says what it does with them.

    Parameters
    ----------
    weights
        T frames.
    head
        With morph targets.
    head_motion
        The head motion of the same T frames: vertices in a frame are ``s R (posed) + t``. R turns
        about the origin, so the head must stand in the coordinates of the neutral that the
        recording was aligned to. t stays in the millimetres of the recording, and s is how much
        larger the recorded face was than that neutral: with a head of another size, neither is
        adapted. By default the head keeps still.

    Returns
    -------
    Animation
        T frames at the rate of the weights.

    Raises
    ------
    ValueError
        If weights and head have no shape in common, a weight could mean two morph targets, or
        weights and head motion differ in their number of frames.

    References
    ----------
    .. [1] C. Curio et al., Semantic 3D motion retargeting for facial animation, APGV '06, 77-84.
    """
    used, _ = driving(weights, head.names, "head")
    return Animation(head=head, weights=used, head_motion=head_motion)
