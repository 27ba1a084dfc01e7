"""Animations: a head that moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Value
from nodegraph_mocap.face_model import HeadMotion, Weights
from nodegraph_mocap.head import Head
from nodegraph_mocap.shape_names import places_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Animation(Value):
    """A head, how much of each morph target it shows over time, and where it is.

    Vertices in a frame are ``s R (vertices + sum(weight * morph)) + t``.

    Attributes
    ----------
    head : Head
    weights : Weights
        Weights of T frames. Each name is one of the head's morph targets, perhaps written by
        another convention (see `nodegraph_mocap.shape_names`).
    head_motion : HeadMotion or None
        The head motion of the same T frames; None where the head keeps still.

    Raises
    ------
    ValueError
        If the frames of weights and head motion differ, or a weight has no morph target, or
        could have two.
    """

    head: Head
    weights: Weights
    head_motion: HeadMotion | None = None

    def __post_init__(self) -> None:
        motion = self.head_motion
        if motion is not None and motion.frames != self.frames:
            raise ValueError(
                f"the weights have {self.frames} frames, the head motion {motion.frames}"
            )
        self._targets()

    @property
    def frames(self) -> int:
        """Number of frames, T."""
        return self.weights.frames

    @property
    def rate(self) -> float:
        """Frames per second."""
        return self.weights.rate

    @property
    def morph_weights(self) -> NDArray[np.float64]:
        """(T, K) weights in the order of the head's morph targets; 0 for one without weights."""
        ordered = np.zeros((self.frames, len(self.head.names)))
        ordered[:, self._targets()] = self.weights.values
        return ordered

    def _targets(self) -> list[int]:
        """Return the place of each weight's morph target."""
        return places_of(self.weights.names, self.head.names, "head", "morph target")
