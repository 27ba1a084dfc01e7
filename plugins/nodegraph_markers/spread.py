"""A few points that stand for all, far apart."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def far_apart(points: NDArray[np.float64], count: int) -> list[int]:
    """Return the numbers of some points, each the farthest from those before it.

    The first is the farthest from the centroid.

    Parameters
    ----------
    points
        (N, 3) mm.
    count
        How many; all of them, if there are fewer.
    """
    nearest = np.linalg.norm(points - points.mean(axis=0), axis=1)
    selected: list[int] = []
    while len(selected) < min(count, len(points)):
        selected.append(int(np.argmax(nearest)))
        away = np.linalg.norm(points - points[selected[-1]], axis=1)
        nearest = away if len(selected) == 1 else np.minimum(nearest, away)
    return selected
