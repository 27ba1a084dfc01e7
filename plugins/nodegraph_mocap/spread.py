"""Points that are spread over others: each the farthest from those before it."""

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
        (N, 3) mm, one at least.
    count
        How many; all of them, if there are fewer.
    """
    first = int(np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1)))
    return [first, *far_from(points, points[[first]], min(count, len(points)) - 1)]


def far_from(points: NDArray[np.float64], taken: NDArray[np.float64], count: int) -> list[int]:
    """Return the numbers of `count` points, each the farthest from those before it and all taken.

    Parameters
    ----------
    points, taken
        (N, D) and (K, D).
    count
        How many.
    """
    nearest = np.linalg.norm(points[:, None] - taken[None], axis=2).min(axis=1)
    selected: list[int] = []
    for _ in range(count):
        selected.append(int(np.argmax(nearest)))
        away = np.linalg.norm(points - points[selected[-1]], axis=1)
        nearest = np.minimum(nearest, away)
    return selected
