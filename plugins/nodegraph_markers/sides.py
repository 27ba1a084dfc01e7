"""Left and right of pairs of markers, and the directions up and to the front."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WORDS = {"left": "right", "l": "r"}
_LEFT, _RIGHT = (
    re.compile(
        rf"(?<![A-Za-z])(?:(?i:{word[0]})(?![A-Za-z])|(?i:{word})(?![a-z]))"
        rf"|(?<=[a-z])(?:{word[0].upper()}(?![A-Za-z])|{word.capitalize()}(?![a-z]))"
    )
    for word in ("left", "right")
)


class Axes(NamedTuple):
    """Directions of a face as unit vectors: across it, up and to the front.

    Attributes
    ----------
    across : (3,) array
        The normal of its mirror plane; its sign is arbitrary.
    up, front : (3,) arrays
        As guessed from geometry and movement.
    """

    across: NDArray[np.float64]
    up: NDArray[np.float64]
    front: NDArray[np.float64]

    @property
    def left(self) -> NDArray[np.float64]:
        """The direction to the face's own left: what is up, turned to what is in front."""
        return np.cross(self.up, self.front)


def side_by_name(name: str, other: str) -> int:
    """Return which name of a pair is of the left side: 1 for the first, -1 for the second.

    Two names have sides if one becomes the other by putting ``left`` for ``right``, or l for r,
    in one place, in letters of either case (``Leyebrow`` and ``Reyebrow``, ``LFHD`` and ``RFHD``,
    ``Chin_L1`` and ``Chin_R1``); or if one bears such a word or letter by itself, and the other
    bears the opposite or none (``L_brow2`` and ``R_brow3``). 0 if they have none.
    """
    small, other_small = name.lower(), other.lower()
    if _becomes(small, other_small):
        return 1
    if _becomes(other_small, small):
        return -1
    return int(np.sign(_side(name) - _side(other)))


def face_axes(
    shape: NDArray[np.float64],
    across: NDArray[np.float64],
    motion: NDArray[np.float64] | None,
) -> Axes:
    """Return the directions up and to the front of a face whose mirror plane is known.

    Up lies along the greatest extent within the plane, the front along the other. The front is
    where the middle of the face stands out from its sides. Up is the end that moves less, for
    jaw and mouth move most; without motion, the wider end. This is a guess, which may be wrong.

    Parameters
    ----------
    shape
        (N, 3) mm.
    across
        The plane's normal.
    motion
        (N,) mm, how much each point moves; None where that is not known.
    """
    centred = shape - shape.mean(axis=0)
    aside = centred @ across
    within = centred - np.outer(aside, across)
    longest, depth = np.linalg.svd(within, full_matrices=False)[2][:2]
    front = depth * (-1.0 if _rises(within @ depth, aside**2) else 1.0)
    lower = -np.abs(aside) if motion is None else motion
    up = longest * (-1.0 if _rises(within @ longest, lower) else 1.0)
    return Axes(across, up, front)


def _becomes(left: str, right: str) -> bool:
    return any(
        left[: match.start()] + replacement + left[match.end() :] == right
        for word, replacement in _WORDS.items()
        for match in re.finditer(word, left)
    )


def _side(name: str) -> int:
    return bool(_LEFT.search(name)) - bool(_RIGHT.search(name))


def _rises(values: NDArray[np.float64], along: NDArray[np.float64]) -> bool:
    return float((values - values.mean()) @ (along - along.mean())) > 0
