"""Detections: what the cameras saw in each frame, before any point has a name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Value
from nodegraph_mocap.checks import finite, indices, possible_rate, set_fields

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Detections(Value):
    """Unlabelled points per frame.

    Attributes
    ----------
    points : (N, 3) array of float64
        Millimetres; all points of frame 0, then all of frame 1, and so on. Their order within a
        frame means nothing.
    offsets : (T + 1,) array of int64
        The points of frame t are ``points[offsets[t]:offsets[t + 1]]``.
    rate : float
        Frames per second.

    Raises
    ------
    ValueError
        If shapes disagree, a coordinate is missing or infinite, or the offsets do not rise from
        0 to N.
    """

    points: NDArray[np.float64]
    offsets: NDArray[np.int64]
    rate: float

    def __post_init__(self) -> None:
        points = finite("points", self.points, ("points", 3))
        offsets = indices("offsets", self.offsets, ("frames + 1",), count=len(points) + 1)
        if not offsets.size or offsets[0] != 0 or offsets[-1] != len(points):
            raise ValueError(f"offsets: must go from 0 to the number of points, {len(points)}")
        if np.any(np.diff(offsets) < 0):
            frame = int(np.argmax(np.diff(offsets) < 0))
            raise ValueError(f"offsets: fall after frame {frame}; they must not")
        set_fields(self, points=points, offsets=offsets, rate=possible_rate(self.rate))

    @property
    def frames(self) -> int:
        """Number of frames, T."""
        return len(self.offsets) - 1
