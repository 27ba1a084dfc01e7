"""The proportions in which one actor's face differs from another's.

A place on any face is written as the place on the average face, (u, v) in millimetres: u to the
left of the face, v up, both from a point between the ears' height and the nose. `Proportions`
says where that place lies on the actor's face.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOUTH_HEIGHT = -36.0
"""Height at which the lips meet on the average face, mm."""

MOUTH_CORNER = 27.0
"""Distance of the lips' corners from the midline on the average face, mm."""

FACE_LENGTH = 190.0
"""From the chin to the hairline on the average face, mm."""

_SPREAD = 0.05
"""Standard deviation of the sizes of a whole face; adults' face widths and heights vary so."""

_FEATURE_SPREAD = 0.12
"""Standard deviation of the sizes of one feature."""

_WHOLE_FACE = ("width", "height", "depth", "mouth_width", "jaw_width")


@dataclass(frozen=True)
class Proportions:
    """Sizes relative to the average face, each about 1.

    Attributes
    ----------
    width, height, depth : float
        Size of the whole face.
    mouth_width, jaw_width : float
        Width of the lower face, on top of `width`.
    nose, brows, cheekbones, lips, chin, sockets : float
        How far each stands out, or lies in.
    """

    width: float = 1.0
    height: float = 1.0
    depth: float = 1.0
    mouth_width: float = 1.0
    jaw_width: float = 1.0
    nose: float = 1.0
    brows: float = 1.0
    cheekbones: float = 1.0
    lips: float = 1.0
    chin: float = 1.0
    sockets: float = 1.0

    @property
    def face_length(self) -> float:
        """From the chin to the hairline, mm."""
        return FACE_LENGTH * self.height

    def place(
        self, u: NDArray[np.float64], v: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return x and y on this face of places on the average face, mm."""
        near_mouth = np.exp(-(((v - MOUTH_HEIGHT) / 16.0) ** 2) - (u / 42.0) ** 4)
        near_jaw = 1.0 / (1.0 + np.exp((v + 45.0) / 12.0))
        widened = 1.0 + (self.mouth_width - 1.0) * near_mouth + (self.jaw_width - 1.0) * near_jaw
        return u * self.width * widened, v * self.height


def draw_proportions(random: np.random.Generator) -> Proportions:
    """Return the proportions of a random actor, none further than two deviations from average."""
    names = [field.name for field in fields(Proportions)]
    spreads = np.array([_SPREAD if name in _WHOLE_FACE else _FEATURE_SPREAD for name in names])
    sizes = 1.0 + spreads * np.clip(random.standard_normal(len(names)), -2.0, 2.0)
    return Proportions(**dict(zip(names, sizes.tolist(), strict=True)))
