"""The landmarks of each frame, for alignments that trust some of them more than others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_align.poses import Scale, Transforms, fit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_align.reference import Reference
    from nodegraph_mocap import Trajectories


@dataclass(frozen=True)
class Fitting:
    """Landmarks, and where they belong.

    Attributes
    ----------
    points : (T, L, 3) array of float64
        Millimetres; NaN where missing.
    shape : (L, 3) array of float64
    scale : Scale
    """

    points: NDArray[np.float64]
    shape: NDArray[np.float64]
    scale: Scale

    @classmethod
    def of(cls, recording: Trajectories, reference: Reference, scale: Scale) -> Fitting:
        """Return the landmarks of a recording."""
        return cls(recording.keep(reference.landmarks).positions, reference.shape, scale)

    @property
    def there(self) -> NDArray[np.bool_]:
        """(T, L), True where a landmark is not missing."""
        return np.asarray(~np.isnan(self.points[..., 0]))

    def some(self, frames: NDArray[np.intp]) -> Fitting:
        """Return those of some frames."""
        return Fitting(self.points[frames], self.shape, self.scale)

    def fit(self, weights: NDArray[np.float64] | None = None) -> Transforms:
        """Return the poses that fit best, with these weights, (T, L), or equal ones."""
        each = np.ones((1, len(self.shape))) if weights is None else weights
        return fit(self.points, np.arange(len(self.shape)), self.shape, each, self.scale)

    def placed(self, poses: Transforms) -> NDArray[np.float64]:
        """Return the landmarks, (T, L, 3), as the poses move them."""
        return poses.moved(self.points, None).positions

    def distances(self, poses: Transforms) -> NDArray[np.float64]:
        """Return how far, (T, L) mm, each landmark is from its place; infinite where missing."""
        x, y, z = np.moveaxis(self.placed(poses) - self.shape, 2, 0)
        # numpy takes seven times as long for sums along so short an axis
        return np.where(self.there, np.sqrt(x * x + y * y + z * z), np.inf)
