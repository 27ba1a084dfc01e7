"""A head that moves as a face did."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from nodegraph import StateForm, node
from nodegraph_blendshapes.shape_matches import shapes_of
from nodegraph_mocap import Animation, AnimationFrame, Head, HeadMotion, HeadPose, Weights

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class _Stream:
    """The animation frame by frame."""

    def __init__(self, weights: Weights, head: Head, head_motion: HeadMotion | None = None) -> None:
        self.header = mesh(weights, head, head_motion)
        self._columns = [weights.names.index(name) for name in self.header.weights.names]

    def push(self, weights: NDArray[np.float64], pose: HeadPose | None = None) -> AnimationFrame:
        return AnimationFrame(weights[self._columns], pose)

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
    Names match across conventions (``EyeBlinkLeft``, ``eyeBlinkLeft``, ``eyeBlink_L``). Weights
    that the head has no morph target for are left out, and morph targets without weight stay at 0;
    warnings count and name both. Missing weights (NaN) stay missing; ``write.glb`` says what it
    does with them.

    Parameters
    ----------
    weights
        T frames.
    head
        With morph targets.
    head_motion
        Of the same T frames: vertices in a frame are ``s R (posed) + t``. R turns about the
        origin, so the head must stand in the coordinates of the neutral that the recording was
        aligned to. t stays in the millimetres of the recording, and s is how much larger the
        recorded face was than that neutral: with a head of another size, neither is adapted. By
        default the head keeps still.

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
    matches = tuple(shapes_of(weights, head.names, "head"))
    columns = [weights.names.index(name) for name in matches]
    driving = replace(weights, values=weights.values[:, columns], names=matches)
    return Animation(head=head, weights=driving, head_motion=head_motion)
