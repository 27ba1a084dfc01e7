"""A take begins at rest: before anything moves, the face is its neutral for a moment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nodegraph_synthesize.smooth_noise import rising

if TYPE_CHECKING:
    from numpy.typing import NDArray

LONGEST_REST = 0.3
"""Seconds."""
_SHARE = 0.1
"""Of a take too short for that, which still has to show something."""


def rest_of(frames: int, rate: float) -> float:
    """Return for how many seconds from its first frame a take is at rest."""
    return min(LONGEST_REST, _SHARE * frames / rate)


def awake(frames: int, rate: float) -> NDArray[np.float64]:
    """Return (T,) 0 at rest and 1 from three times as long on, with a smooth step between."""
    rest = rest_of(frames, rate)
    return rising(np.arange(frames) / rate, rest, 3.0 * rest)
