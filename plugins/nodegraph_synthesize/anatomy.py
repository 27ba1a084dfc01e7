"""Movement of a face by its muscles and its jaw.

A pose is computed in this order: the jaw turns about the line through its
joints, which slide forwards; the muscles pull each point, from where the jaw has left it, towards
their attachments, and eyes close; the skin gives way less and less; and it slides over the skull
instead of leaving it. So the displacement is not linear in the activations, and muscles that act
together are not the sum of what each does alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.eyelids import EYELIDS, eyelid_offsets
from nodegraph_synthesize.muscles import (
    CHANNELS,
    JAW,
    KINDS,
    PUFF,
    SPHINCTER,
    Pull,
    kind_of,
    linear_muscles,
    puff_offsets,
    pull_of,
    sphincter_offsets,
)
from nodegraph_synthesize.proportions import MOUTH_CORNER, MOUTH_HEIGHT, Proportions
from nodegraph_synthesize.surface import skull_depth

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

_JAW_ANGLE = np.radians(18.0)
"""Angle of the wide open jaw: the chin falls about 33 mm. Speech takes a third of it and less."""
_JAW_JOINT = (15.0, -45.0)
"""y and z of the axis through the jaw's joints, mm on the average face."""
_JAW_GLIDE = (-4.0, 9.0)
"""Distance that the joints themselves slide down and forwards when the jaw opens wide, mm."""
_STRETCH = 30.0
"""A pull of this length, mm, is shortened to 1 / sqrt(2) by the skin's stiffness."""


@dataclass(frozen=True)
class Anatomy:
    """Points on an actor's face, and the muscles that move them.

    Attributes
    ----------
    points : (N, 3) array
        At rest, mm.
    proportions : Proportions
    strengths : mapping of channel to float
        Strengths of this actor's channels, about 1.
    pulls : mapping of channel to Pull
    shifts : mapping of channel to (N, 3) array
        Offsets of the fully narrowed mouth, of blown-up cheeks and of each closed eye, mm.
    """

    points: NDArray[np.float64]
    proportions: Proportions
    strengths: Mapping[str, float]
    pulls: Mapping[str, Pull]
    shifts: Mapping[str, NDArray[np.float64]]

    def offsets(self, activations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (T, N, 3) mm by which (T, K) activations move the points."""
        levels = activations * np.array([self.strengths[name] for name in CHANNELS])
        level = dict(zip(CHANNELS, levels.T[:, :, None, None], strict=True))
        opened = self._opened(self.points, level[JAW])
        pulled = np.zeros_like(opened)
        for name, shift in self.shifts.items():
            moved = shift.any(axis=1)
            pulled[:, moved] += level[name] * shift[moved]
        for name, pull in self.pulls.items():
            # few activate a muscle at any time, and of the morph targets one does
            at = np.flatnonzero(level[name])
            towards = self._opened(pull.attachment[None], level[JAW][at])
            towards = towards - opened[np.ix_(at, pull.points)]
            towards /= np.linalg.norm(towards, axis=2, keepdims=True)
            pulled[np.ix_(at, pull.points)] += level[name][at] * pull.amounts[:, None] * towards
        return self._slid(opened, _stiffened(pulled)) - self.points

    def _opened(
        self, points: NDArray[np.float64], level: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return (T, N, 3) points, or attachments, where the jaw's turn has left them."""
        share = level[..., 0] * _jaw_share(points, self.proportions)
        y = points[:, 1] - _JAW_JOINT[0] * self.proportions.height
        z = points[:, 2] - _JAW_JOINT[1] * self.proportions.depth
        sine, versine = np.sin(_JAW_ANGLE * share), 1.0 - np.cos(_JAW_ANGLE * share)
        moved = np.broadcast_to(points, (*share.shape, 3)).copy()
        moved[..., 1] += _JAW_GLIDE[0] * share - sine * z - versine * y
        moved[..., 2] += _JAW_GLIDE[1] * share + sine * y - versine * z
        return moved

    def _slid(
        self, opened: NDArray[np.float64], pulled: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        moved = opened + pulled
        before = skull_depth(opened[..., 0], opened[..., 1], self.proportions)
        after = skull_depth(moved[..., 0], moved[..., 1], self.proportions)
        # Half of what the skull prescribes: soft tissue lies between it and the skin.
        moved[..., 2] += 0.5 * (after - before - pulled[..., 2])
        return moved


def make_anatomy(
    points: NDArray[np.float64], proportions: Proportions, strengths: Mapping[str, float]
) -> Anatomy:
    """Return the anatomy that moves (N, 3) points of a neutral face of these proportions."""
    pulls = {
        name: pull_of(muscle, points, proportions) for name, muscle in linear_muscles().items()
    }
    shifts = {
        SPHINCTER: sphincter_offsets(points, proportions),
        PUFF: puff_offsets(points, proportions),
        **eyelid_offsets(points, proportions),
    }
    return Anatomy(points, proportions, strengths, pulls, shifts)


def draw_strengths(random: np.random.Generator) -> dict[str, float]:
    """Return the muscle strengths of a random actor, equal on both sides.

    The eyelids always have strength 1, so that the eyes close exactly.
    """
    drawn = np.exp(np.clip(0.15 * random.standard_normal(len(KINDS)), -0.3, 0.3))
    strength = dict(zip(KINDS, drawn.tolist(), strict=True)) | {EYELIDS: 1.0}
    return {name: strength[kind_of(name)] for name in CHANNELS}


def _jaw_share(points: NDArray[np.float64], proportions: Proportions) -> NDArray[np.float64]:
    """Return how much of the jaw's turn each point follows, 0 to 1.

    In the middle the lower lip goes with the jaw and the upper does not. Towards the corners of
    the mouth, which stay half-way, each passes on more and more to the other; so do the cheeks.
    """
    corner, height = proportions.place(np.array(MOUTH_CORNER), np.array(MOUTH_HEIGHT))
    across = np.abs(points[:, 0]) / corner
    joined = np.sin(np.minimum(across, 1.0) * np.pi / 2) ** 2
    reach = 5.0 + 9.0 * (1.0 - np.exp(-((0.75 * across) ** 2)))
    above = (points[:, 1] - height) / proportions.height
    passed = 0.5 * joined * np.exp(-np.abs(above) / reach)
    return np.where(above > 0.0, passed, 1.0 - passed)


def _stiffened(pulled: NDArray[np.float64]) -> NDArray[np.float64]:
    squares = np.sum(pulled**2, axis=-1, keepdims=True)
    return np.asarray(pulled / np.sqrt(1.0 + squares / _STRETCH**2))
