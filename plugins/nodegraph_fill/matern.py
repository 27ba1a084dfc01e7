"""Gaussian processes over time with the Matern 5/2 covariance, and noise, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MOST_FRAMES = 2000
"""Consecutive frames by which a process is fitted, those with the most samples."""
_OWN_LENGTH, _OWN_NOISE = 10.0, 1e-3


class Matern(NamedTuple):
    """A process of the coordinates of a marker and the noise of its samples.

    ``cov(x[t], x[u]) = variance (1 + d + d^2 / 3) exp(-d)``, ``d = sqrt(5) |t - u| / length``.

    Attributes
    ----------
    length : float
        Frames.
    noise, variance : float
        mm^2, per coordinate.
    """

    length: float
    noise: float
    variance: float

    @staticmethod
    def fitted(
        rows: NDArray[np.float64], seen: NDArray[np.bool_], length: float, noise: float
    ) -> Matern:
        """Return the most likely process of rows, (T, 3), mm, where seen, (T,).

        The search begins from a length and a noise relative to the variance. It learns from 2,000
        frames in a row at most, those with the most samples.
        """
        from nodegraph_fill import matern_kernel

        if len(rows) > _MOST_FRAMES:
            count = np.concatenate([[0], np.cumsum(seen)])
            start = int(np.argmax(count[_MOST_FRAMES:] - count[:-_MOST_FRAMES]))
            rows, seen = rows[start : start + _MOST_FRAMES], seen[start : start + _MOST_FRAMES]
        if not rows[seen].any():
            return Matern(length, noise, 1.0)  # what never moves stays, whatever the variance
        found = matern_kernel.fit(
            np.ascontiguousarray(rows), np.ascontiguousarray(seen), length, noise
        )
        return Matern(found[0], found[1] * found[2], found[2])


@dataclass(frozen=True)
class Courses:
    """The markers of a take, each a process of its own.

    Attributes
    ----------
    rows : (T, M, 3) array of float64
        Millimetres from the marker's mean, 0 where not seen.
    seen : (T, M) array of bool
    middle : (M, 3) array of float64
        The means, NaN for a marker never seen.
    """

    rows: NDArray[np.float64]
    seen: NDArray[np.bool_]
    middle: NDArray[np.float64]

    @staticmethod
    def of(positions: NDArray[np.float64], seen: NDArray[np.bool_]) -> Courses:
        """Return the courses of positions, (T, M, 3), where seen."""
        count = np.count_nonzero(seen, axis=0)[:, None]
        # away from the origin first: a mean of large numbers loses digits
        start = positions[seen.argmax(axis=0), np.arange(positions.shape[1])]
        shown = np.where(seen[..., None], positions - start, 0.0)
        middle = np.where(count > 0, shown.sum(axis=0) / np.maximum(count, 1), np.nan)
        rows = np.where(seen[..., None], shown - middle, 0.0)
        return Courses(rows, seen, start + middle)

    def fitted(self, marker: int) -> Matern:
        """Return the most likely process of a marker."""
        rows, seen = self.rows[:, marker], self.seen[:, marker]
        return Matern.fitted(rows, seen, _OWN_LENGTH, _OWN_NOISE)

    def smoothed(
        self, marker: int, process: Matern
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return mean, (T, 3), and variance, (T,), of a marker, its samples being known."""
        from nodegraph_fill import matern_kernel

        return matern_kernel.smooth(
            np.array([process.length]),
            np.array([process.variance]),
            np.array([process.noise]),
            np.ascontiguousarray(self.rows[:, [marker]]),
            self.seen[:, [marker]],
            0,
            len(self.rows),
        )
