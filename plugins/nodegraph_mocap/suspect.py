"""Single samples of a truth that are far off those around them, to which no error should count."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

FACTOR = 8.0
"""Of 231,000 samples of faces without impulses, 1 is above; of impulses of 4 mm and more, 98 %."""
OPPOSITE = 0.25
"""Half of what an impulse on a straight movement makes of the samples beside it."""


def impulses(positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the deviation of samples that look like an impulse.

    With ``m[t] = x[t] - (x[t-1] + x[t+1]) / 2``, a marker's sample off the midpoint of its
    neighbours, an impulse e at t makes ``m[t] = e`` and ``m[t-1] = m[t+1] = -e / 2``. Frame t is
    one where ``|m[t]|`` exceeds 8 times the marker's median of ``|m|``, and both
    ``m[t-1] . m[t]`` and ``m[t+1] . m[t]`` lie below ``-|m[t]|^2 / 4``: fast movement is large in
    m over several frames in one direction, and an impulse is not. Of the two neighbours, one that
    has no m, beside a gap or at an end of the take, does not count.

    Parameters
    ----------
    positions
        (T, M, 3) mm, NaN where missing.

    Returns
    -------
    (T, M) array of float64
        mm, ``|m[t]|`` where there is an impulse, else 0. One that lasts two frames or more is
        not recognized.
    """
    off = np.full((positions.shape[0] + 2, *positions.shape[1:]), np.nan)
    off[2:-2] = positions[1:-1] - (positions[:-2] + positions[2:]) / 2.0
    middle = off[1:-1]
    distance = lengths(middle)
    before, after = (np.einsum("tmc,tmc->tm", middle, side) for side in (off[:-2], off[2:]))
    limit = -OPPOSITE * distance**2
    opposed = ((before < limit) | np.isnan(before)) & ((after < limit) | np.isnan(after))
    opposed &= ~(np.isnan(before) & np.isnan(after))
    return np.where(opposed & (distance > FACTOR * usual(distance)), distance, 0.0)


def lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the Euclidean lengths of vectors, (..., 3)."""
    # the coordinates apart: `np.linalg.norm` along an axis of three takes several times as long
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.asarray(np.sqrt(x * x + y * y + z * z))


def usual(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the median of each marker; NaN for one that has no number."""
    ordered = np.sort(distance, axis=0)  # NaN last; nanmedian takes several times as long
    last = np.maximum(np.count_nonzero(~np.isnan(distance), axis=0) - 1, 0)
    columns = np.arange(distance.shape[1])
    return np.asarray((ordered[last // 2, columns] + ordered[(last + 1) // 2, columns]) / 2.0)
