"""The neutral face: a smooth height map over an oval, left and right exact mirrors.

Coordinates are those of a head: x to the left of the face, y up, z forward, in millimetres, with
the origin inside the head, about between the ears.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.proportions import MOUTH_CORNER, MOUTH_HEIGHT

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_synthesize.proportions import Proportions

HALF_COLUMNS = 20
"""Columns of vertices on each side of the midline."""

_LOWEST, _HIGHEST = -95.0, 95.0
_LIP_GAP = 0.8
"""Between the rows of vertices on both sides of the closed mouth, mm."""
_ROW_SPACING = 3.8

_FRONT = 62.0
"""z of the skull between the eyes, mm."""
_DEPTH = 122.0
"""Depth of the half oval that is the skull's horizontal section, mm."""

_CENTRAL = (
    # part, height of the bump in mm, centre v, half-widths in u and v
    ("nose", 19.0, -3.0, 9.5, 8.0),
    ("nose", 9.0, 12.0, 7.0, 13.0),
    ("nose", 3.5, 29.0, 7.5, 9.0),
    ("brows", 2.0, 44.0, 14.0, 9.0),
    ("lips", 4.0, -36.0, 28.0, 18.0),
    ("lips", 3.5, -29.5, 17.0, 5.0),
    ("lips", 4.5, -43.0, 15.0, 5.5),
    ("lips", -3.0, MOUTH_HEIGHT, 22.0, 2.6),
    ("lips", -0.8, -21.0, 3.0, 5.0),
    ("chin", -3.5, -54.5, 17.0, 6.0),
    ("chin", 6.0, -73.0, 17.0, 12.0),
)
_PAIRED = (
    # part, height of the bump in mm, centre u and v, half-widths in u and v
    ("nose", 7.0, 12.5, -5.0, 5.5, 6.5),
    ("brows", 3.5, 27.0, 45.0, 19.0, 8.0),
    ("sockets", -10.0, 31.0, 27.0, 15.0, 10.5),
    ("sockets", -4.0, 16.0, 27.0, 6.0, 8.0),
    ("sockets", 6.5, 31.0, 26.0, 10.5, 7.0),
    ("cheekbones", 4.0, 44.0, 5.0, 16.0, 13.0),
    ("cheekbones", -1.5, 26.0, -20.0, 5.0, 12.0),
)


@dataclass(frozen=True)
class Surface:
    """A neutral face.

    Attributes
    ----------
    places : (V, 2) array
        Each vertex on the average face, (u, v) in mm.
    vertices : (V, 3) array
        The same on the actor's face, mm.
    faces : (F, 3) array
        Triangles, counter-clockwise from the front; none across the lips, so that a mouth opens.
    """

    places: NDArray[np.float64]
    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]


def make_surface(proportions: Proportions) -> Surface:
    """Return the neutral face of these proportions."""
    places, faces = _grid()
    return Surface(places, on_face(places, proportions), faces)


def on_face(places: NDArray[np.float64], proportions: Proportions) -> NDArray[np.float64]:
    """Return (N, 3) mm on the actor's face of (N, 2) places on the average face."""
    u, v = places[:, 0], places[:, 1]
    x, y = proportions.place(u, v)
    z = proportions.depth * (_skull(u, v) + _features(u, v, proportions))
    return np.stack([x, y, z], axis=1)


def skull_depth(
    x: NDArray[np.float64], y: NDArray[np.float64], proportions: Proportions
) -> NDArray[np.float64]:
    """Return z of the skull under a point of the actor's face, mm: what the skin slides on."""
    return proportions.depth * _skull(x / proportions.width, y / proportions.height)


def _half_width(v: NDArray[np.float64]) -> NDArray[np.float64]:
    above = np.sqrt(1.0 - np.clip(v / 125.0, 0.0, 0.95) ** 3)
    below = np.sqrt(1.0 - np.clip(-v / 104.0, 0.0, 0.95) ** 2.2)
    return np.asarray(69.0 * np.where(v > 0, above, below))


def _skull(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the depth without features: flat in front, and steep at the temples and the jaw."""
    outward = np.clip((u / (1.04 * _half_width(v))) ** 2, 0.0, 1.0)
    forehead = 24.0 * (np.maximum(v - 30.0, 0.0) / 65.0) ** 2
    jaw = 14.0 * (np.maximum(-30.0 - v, 0.0) / 60.0) ** 2
    sides = np.sqrt(1.0 - 0.95 * outward**1.25)
    return np.asarray(_DEPTH * sides + _FRONT - _DEPTH - forehead - jaw)


def _features(
    u: NDArray[np.float64], v: NDArray[np.float64], proportions: Proportions
) -> NDArray[np.float64]:
    total = np.zeros_like(u)
    for part, height, v0, du, dv in _CENTRAL:
        bump = np.exp(-((u / du) ** 2) - ((v - v0) / dv) ** 2)
        total += getattr(proportions, part) * height * bump
    for part, height, u0, v0, du, dv in _PAIRED:
        # The sum of both sides' bumps is the same number at u and -u, so mirrors are exact.
        across = np.exp(-(((u - u0) / du) ** 2)) + np.exp(-(((u + u0) / du) ** 2))
        along = np.exp(-(((v - v0) / dv) ** 2))
        total += getattr(proportions, part) * height * across * along
    return total


def _grid() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    rows, upper_lip = _rows()
    side = np.arange(1, HALF_COLUMNS + 1) / HALF_COLUMNS
    columns = np.concatenate([-side[::-1], [0.0], side])
    u = _half_width(rows)[:, None] * columns
    v = np.broadcast_to(rows[:, None], u.shape)
    return np.stack([u.ravel(), v.ravel()], axis=1), _triangles(u, upper_lip)


def _rows() -> tuple[NDArray[np.float64], int]:
    lower, upper = MOUTH_HEIGHT - _LIP_GAP / 2, MOUTH_HEIGHT + _LIP_GAP / 2
    below = np.linspace(_LOWEST, lower, round((lower - _LOWEST) / _ROW_SPACING) + 1)
    above = np.linspace(upper, _HIGHEST, round((_HIGHEST - upper) / _ROW_SPACING) + 1)
    return np.concatenate([below, above]), len(below)


def _triangles(u: NDArray[np.float64], upper_lip: int) -> NDArray[np.int64]:
    rows, columns = u.shape
    row, column = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    low = row * columns + column
    high = low + columns
    # Mirrored diagonals, so that the triangles are symmetric as well as the vertices.
    on_left = column >= HALF_COLUMNS
    first = np.where(
        on_left[..., None],
        np.stack([low, low + 1, high + 1], axis=-1),
        np.stack([low, low + 1, high], axis=-1),
    )
    second = np.where(
        on_left[..., None],
        np.stack([low, high + 1, high], axis=-1),
        np.stack([low + 1, high + 1, high], axis=-1),
    )
    widest = np.maximum(np.abs(u[:-1, :-1]), np.abs(u[:-1, 1:]))
    between_lips = (row == upper_lip - 1) & (widest <= MOUTH_CORNER)
    return np.concatenate([first[~between_lips], second[~between_lips]]).astype(np.int64)
