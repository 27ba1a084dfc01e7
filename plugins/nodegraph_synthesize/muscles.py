"""Muscles of Waters' kinds: linear ones that pull towards a bone, and one that narrows the mouth.

A linear muscle runs from its attachment on the bone to its insertion in the skin. A point of the
skin at distance D from the attachment, at an angle A from the muscle's direction, is pulled
towards the attachment by ``pull * cos(A / zone * pi / 2) * r(D)``, with

    r(D) = cos((1 - D / Rs) pi / 2)               for D <= Rs,
    r(D) = cos((D - Rs) / (Rf - Rs) pi / 2)       for Rs < D <= Rf, 0 beyond

(Waters 1987). Waters takes cos(A) inside the zone, which ends in a step; here the pull reaches
zero at the zone's edge.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.eyelids import EYELIDS
from nodegraph_synthesize.proportions import MOUTH_HEIGHT, Proportions
from nodegraph_synthesize.surface import on_face

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class LinearMuscle:
    """One muscle of the left side, or of the midline; places on the average face in mm.

    Attributes
    ----------
    attachment, insertion : (u, v)
    full, end : float
        Rs, where the pull is largest, and Rf, where it ends, in lengths of the muscle from the
        attachment.
    zone : float
        Degrees to each side of the muscle's direction.
    pull : float
        Pull of a point at Rs on the muscle's line, at full activation, on the average face, mm.
    """

    attachment: tuple[float, float]
    insertion: tuple[float, float]
    full: float
    end: float
    zone: float
    pull: float

    def mirrored(self) -> LinearMuscle:
        """Return the muscle of the other side."""
        (au, av), (iu, iv) = self.attachment, self.insertion
        return LinearMuscle((-au, av), (-iu, iv), self.full, self.end, self.zone, self.pull)


PAIRED = {
    "frontalisInner": LinearMuscle((15.0, 90.0), (15.0, 46.0), 0.95, 1.25, 34.0, 12.0),
    "frontalisOuter": LinearMuscle((42.0, 86.0), (42.0, 49.0), 0.95, 1.4, 28.0, 11.0),
    "corrugator": LinearMuscle((3.0, 36.0), (26.0, 48.0), 0.9, 1.6, 35.0, 8.0),
    "cheekSquint": LinearMuscle((33.0, 23.0), (37.0, -4.0), 0.95, 1.6, 62.0, 12.0),
    "levatorNasi": LinearMuscle((9.0, 28.0), (14.0, -8.0), 0.95, 1.6, 27.0, 9.0),
    "levatorLabii": LinearMuscle((20.0, 18.0), (14.0, -29.0), 0.95, 1.28, 24.0, 11.0),
    "zygomaticMajor": LinearMuscle((54.0, 8.0), (27.0, -36.0), 0.95, 1.5, 34.0, 16.0),
    "platysma": LinearMuscle((60.0, -44.0), (27.0, -37.0), 0.95, 1.5, 34.0, 13.0),
    "depressorAnguliOris": LinearMuscle((33.0, -86.0), (27.0, -38.0), 0.95, 1.3, 26.0, 15.0),
    "depressorLabii": LinearMuscle((16.0, -84.0), (12.0, -45.0), 0.95, 1.3, 26.0, 10.0),
}
CENTRAL = {"mentalis": LinearMuscle((0.0, -36.0), (0.0, -73.0), 0.9, 1.5, 45.0, 8.0)}
JAW, SPHINCTER, PUFF = "jawOpen", "orbicularisOris", "cheekPuff"

CHANNELS = (
    JAW,
    SPHINCTER,
    PUFF,
    *CENTRAL,
    *(f"{name}{side}" for name in (*PAIRED, EYELIDS) for side in ("Left", "Right")),
)
"""Names of what is activated, in the order of the weights."""


def kind_of(channel: str) -> str:
    """Return the muscle of a channel, of either side."""
    return channel.removesuffix("Left").removesuffix("Right")


KINDS = tuple(dict.fromkeys(map(kind_of, CHANNELS)))
"""The muscles, each once."""


@dataclass(frozen=True)
class Pull:
    """Displacements of points of the neutral face by one muscle.

    Attributes
    ----------
    points : (n,) array
        The points that it moves.
    attachment : (3,) array
        The point towards which it pulls, mm.
    amounts : (n,) array
        Displacements at full activation, mm.
    """

    points: NDArray[np.intp]
    attachment: NDArray[np.float64]
    amounts: NDArray[np.float64]


def linear_muscles() -> dict[str, LinearMuscle]:
    """Return every linear muscle by the name of its channel."""
    muscles = dict(CENTRAL)
    for name, muscle in PAIRED.items():
        muscles[f"{name}Left"] = muscle
        muscles[f"{name}Right"] = muscle.mirrored()
    return muscles


def pull_of(muscle: LinearMuscle, points: NDArray[np.float64], proportions: Proportions) -> Pull:
    """Return the pull of a linear muscle on (N, 3) points of the neutral face."""
    ends = np.array([muscle.attachment, muscle.insertion])
    attachment, insertion = on_face(ends, proportions)
    line = insertion - attachment
    length = np.linalg.norm(line)
    rays = points - attachment
    distances = np.linalg.norm(rays, axis=1)
    cosines = rays @ line / np.maximum(distances * length, 1e-12)
    angles = np.degrees(np.arccos(np.clip(cosines, -1.0, 1.0)))
    sideways = np.cos(np.minimum(angles / muscle.zone, 1.0) * np.pi / 2)
    amounts = muscle.pull * proportions.height * sideways * _along(muscle, distances / length)
    moved = np.flatnonzero(amounts > 1e-6)
    return Pull(moved, attachment, amounts[moved])


def sphincter_offsets(points: NDArray[np.float64], proportions: Proportions) -> NDArray[np.float64]:
    """Return (N, 3) mm by which the muscle around the mouth, fully active, moves each point.

    An ellipse on the lips: points on it move furthest, inwards and forwards (Waters' sphincter
    muscle, with his radial term for both directions and the pouting of the lips on top).
    """
    corner = on_face(np.array([[27.0, MOUTH_HEIGHT]]), proportions)[0]
    across = points[:, 0] / corner[0]
    along = (points[:, 1] - corner[1]) / (12.0 * proportions.height)
    radius = np.hypot(across, along)
    strength = np.where(
        radius <= 1.0,
        np.sin(radius * np.pi / 2),
        np.cos(np.minimum(radius - 1.0, 1.0) * np.pi / 2),
    )
    inwards = strength / np.maximum(radius, 1e-12)
    pout = np.cos(np.minimum(radius / 2.0, 1.0) * np.pi / 2) ** 2
    return np.stack([-10.0 * inwards * across, -3.0 * inwards * along, 16.0 * pout], axis=1)


def puff_offsets(points: NDArray[np.float64], proportions: Proportions) -> NDArray[np.float64]:
    """Return (N, 3) mm by which the air in both cheeks, blown up fully, moves each point.

    A bump on each side, outwards and forwards; no muscle of Waters' kinds does this.
    """
    u, v = points[:, 0] / proportions.width, points[:, 1] / proportions.height
    across = np.exp(-(((np.abs(u) - 45.0) / 14.0) ** 2))
    bump = 20.0 * across * np.exp(-(((v + 26.0) / 18.0) ** 2))
    return np.stack([0.75 * np.sign(u) * bump, np.zeros_like(u), 0.65 * bump], axis=1)


def _along(muscle: LinearMuscle, distances: NDArray[np.float64]) -> NDArray[np.float64]:
    rising = np.cos((1.0 - distances / muscle.full) * np.pi / 2)
    beyond = np.clip((distances - muscle.full) / (muscle.end - muscle.full), 0.0, 1.0)
    return np.where(distances <= muscle.full, rising, np.cos(beyond * np.pi / 2))
