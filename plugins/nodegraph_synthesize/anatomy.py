"""How a face moves: its points, its muscles and its jaw, put together.

A pose is computed in the order in which it happens: the jaw turns about the line through its
joints; the muscles pull each point, from where the jaw has left it, towards their attachments;
the skin gives way less and less; and it slides over the skull instead of leaving it. So the
displacement is not linear in the activations, and muscles that act together are not the sum of
what each does alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.muscles import (
    CHANNELS,
    JAW,
    SPHINCTER,
    Pull,
    linear_muscles,
    pull_of,
    sphincter_offsets,
)
from nodegraph_synthesize.proportions import MOUTH_HEIGHT, Proportions
from nodegraph_synthesize.surface import skull_depth

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

_JAW_ANGLE = np.radians(7.0)
"""Of the fully open jaw: the chin falls about 15 mm."""
_JAW_JOINT = (15.0, -45.0)
"""y and z of the axis through the jaw's joints, mm on the average face."""
_STRETCH = 30.0
"""A pull of this length, mm, is shortened to 1 / sqrt(2) by the skin's stiffness."""


@dataclass(frozen=True)
class Anatomy:
    """Points on one actor's face and what moves them.

    Attributes
    ----------
    points : (N, 3) array
        At rest, mm.
    proportions : Proportions
    strengths : mapping of channel to float
        Of this actor, about 1.
    pulls : mapping of channel to Pull
    sphincter : (N, 3) array
        Offsets of the fully narrowed mouth, mm.
    """

    points: NDArray[np.float64]
    proportions: Proportions
    strengths: Mapping[str, float]
    pulls: Mapping[str, Pull]
    sphincter: NDArray[np.float64]

    def offsets(self, activations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (T, N, 3) mm by which (T, K) activations move the points."""
        levels = activations * np.array([self.strengths[name] for name in CHANNELS])
        level = dict(zip(CHANNELS, levels.T[:, :, None, None], strict=True))
        opened = self._opened(self.points, level[JAW])
        pulled = level[SPHINCTER] * self.sphincter
        for name, pull in self.pulls.items():
            towards = self._opened(pull.attachment[None], level[JAW]) - opened[:, pull.points]
            towards /= np.linalg.norm(towards, axis=2, keepdims=True)
            pulled[:, pull.points] += level[name] * pull.amounts[:, None] * towards
        return self._slid(opened, _stiffened(pulled)) - self.points

    def _opened(
        self, points: NDArray[np.float64], level: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return (T, N, 3) points, or attachments, where the jaw's turn has left them."""
        angle = _JAW_ANGLE * level[..., 0] * _jaw_share(points, self.proportions)
        y = points[:, 1] - _JAW_JOINT[0] * self.proportions.height
        z = points[:, 2] - _JAW_JOINT[1] * self.proportions.depth
        sine, versine = np.sin(angle), 1.0 - np.cos(angle)
        moved = np.broadcast_to(points, (*angle.shape, 3)).copy()
        moved[..., 1] -= sine * z + versine * y
        moved[..., 2] += sine * y - versine * z
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
    """Return what moves (N, 3) points of the neutral face of these proportions."""
    pulls = {
        name: pull_of(muscle, points, proportions) for name, muscle in linear_muscles().items()
    }
    return Anatomy(
        points,
        proportions,
        strengths,
        pulls,
        sphincter_offsets(points, proportions),
    )


def draw_strengths(random: np.random.Generator) -> dict[str, float]:
    """Return how strong a random actor's muscles are; left and right alike."""
    kinds = list(dict.fromkeys(_kind(name) for name in CHANNELS))
    drawn = np.exp(np.clip(0.15 * random.standard_normal(len(kinds)), -0.3, 0.3))
    strength = dict(zip(kinds, drawn.tolist(), strict=True))
    return {name: strength[_kind(name)] for name in CHANNELS}


def _kind(channel: str) -> str:
    return channel.removesuffix("Left").removesuffix("Right")


def _jaw_share(points: NDArray[np.float64], proportions: Proportions) -> NDArray[np.float64]:
    """Return how much of the jaw's turn each point follows, 0 to 1.

    The lower lip goes with the jaw and the upper does not; the cheeks pass smoothly.
    """
    across = points[:, 0] / (36.0 * proportions.width)
    softness = 1.0 + 11.0 * (1.0 - np.exp(-(across**2)))
    above = points[:, 1] / proportions.height - MOUTH_HEIGHT
    return np.asarray(1.0 / (1.0 + np.exp(above / softness)))


def _stiffened(pulled: NDArray[np.float64]) -> NDArray[np.float64]:
    squares = np.sum(pulled**2, axis=-1, keepdims=True)
    return np.asarray(pulled / np.sqrt(1.0 + squares / _STRETCH**2))
