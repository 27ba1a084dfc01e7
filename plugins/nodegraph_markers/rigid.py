"""Rigid bodies: their pose in each frame, from weighted points, and measures of their shape."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_ON_A_LINE = 1e-3
"""Second singular value to the first, below which points tell no rotation."""


class RigidMotions(NamedTuple):
    """Rigid motions of each frame's points onto the shape: ``R p + t``.

    Attributes
    ----------
    rotations : (T, 3, 3) array of float64
    translations : (T, 3) array of float64
    known : (T,) array of bool
        False where the points are too few or on a line; nothing is moved there.
    """

    rotations: NDArray[np.float64]
    translations: NDArray[np.float64]
    known: NDArray[np.bool_]

    def apply(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points of every frame, (T, N, 3), on the shape."""
        return points @ self.rotations.transpose(0, 2, 1) + self.translations[:, np.newaxis]


def fit(
    points: NDArray[np.float64],
    shape: NDArray[np.float64],
    weights: NDArray[np.float64],
    *,
    fewest: int = 3,
) -> RigidMotions:
    """Return the proper rigid motion of each frame that minimizes ``sum(w |R p + t - q|^2)``.

    The rotation follows from the singular value decomposition of the weighted covariance, with
    its determinant made 1 (Kabsch), so that a face is never mirrored.

    Parameters
    ----------
    points
        (T, N, 3); NaN only where the weight is 0.
    shape
        (N, 3), the points' places q, or (T, N, 3) for each frame.
    weights
        (T, N), none negative.
    fewest
        Frames with fewer points of positive weight have no pose.
    """
    used = weights > 0
    total = np.maximum(weights.sum(axis=1), np.finfo(float).tiny)[:, np.newaxis]
    points = np.where(used[..., np.newaxis], points, 0.0)
    target = np.where(np.isnan(shape), 0.0, shape)
    share = weights / total
    middle = (share[:, np.newaxis] @ points)[:, 0]
    goal = (share[:, np.newaxis] @ target)[:, 0]
    weighted = share[..., np.newaxis] * (points - middle[:, np.newaxis])
    covariance = weighted.transpose(0, 2, 1) @ (target - goal[:, np.newaxis])
    u, sizes, v = np.linalg.svd(covariance)
    u[:, :, 2] *= np.where(np.linalg.det(u @ v) < 0, -1.0, 1.0)[:, np.newaxis]
    rotations = (u @ v).transpose(0, 2, 1)
    known = (used.sum(axis=1) >= fewest) & (sizes[:, 1] > _ON_A_LINE * sizes[:, 0])
    rotations[~known] = np.eye(3)
    translations = np.where(
        known[:, np.newaxis], goal - (rotations @ middle[..., np.newaxis])[..., 0], 0.0
    )
    return RigidMotions(rotations, translations, known)


def fit_robustly(
    points: NDArray[np.float64],
    shape: NDArray[np.float64],
    used: NDArray[np.bool_],
    *,
    width: float,
    fewest: int = 3,
) -> RigidMotions:
    """Return the poses of a robust fit, in which far points count less.

    Parameters
    ----------
    points, shape, fewest
        As for `fit`.
    used
        (T, N), which points there are.
    width
        Millimetres; a point that is off by r has the weight ``1 / (1 + (r / width)^2)^2`` in the
        next of three fits (Geman & McClure).
    """
    poses = fit(points, shape, used.astype(np.float64), fewest=fewest)
    for _ in range(3):
        errors = ((poses.apply(points) - shape) ** 2).sum(axis=2)
        weights = np.where(used, 1.0 / (1.0 + np.where(used, errors, 0.0) / width**2) ** 2, 0.0)
        poses = fit(points, shape, weights, fewest=fewest)
    return poses


def on_a_line(shape: NDArray[np.float64]) -> bool:
    """Return whether points, (N, 3), lie on a line, so that their rotation is undefined."""
    sizes = np.linalg.svd(shape - shape.mean(axis=0), compute_uv=False)
    return bool(sizes[1] ** 2 <= _ON_A_LINE * sizes[0] ** 2)


def spacing(shape: NDArray[np.float64]) -> float:
    """Return the median distance from a point to the nearest other one; NaN points are left out.

    Infinite where there are no two points in different places.
    """
    from scipy.spatial import KDTree

    places = np.unique(shape[~np.isnan(shape[:, 0])], axis=0)
    if len(places) < 2:
        return float("inf")
    distances, _ = KDTree(places).query(places, k=[2])
    return float(np.median(distances))
