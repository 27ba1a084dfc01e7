"""The pose in which unnamed points fit a shape best, whatever their pose and order."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_markers.rigid import RigidMotions, fit, fit_robustly
from nodegraph_mocap.spread import far_apart

if TYPE_CHECKING:
    from numpy.typing import NDArray

_CORNERS, _ALIKE, _REFINED, _STEPS = 6, 150, 16, 30
_AT_ONCE = 1000


class Match(NamedTuple):
    """Pose and assignment that bring points onto a shape.

    Attributes
    ----------
    rotation : (3, 3) array
    translation : (3,) array
    point, place : (L,) arrays of int
        Numbers of the points, and of the places of the shape that they are at; none twice.
    cost : float
        Mean over the places of the squared distance to their point, mm^2; none counts more than
        the squared width, nor does a place without a point.
    """

    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]
    point: NDArray[np.intp]
    place: NDArray[np.intp]
    cost: float


def register(points: NDArray[np.float64], shape: NDArray[np.float64], width: float) -> Match | None:
    """Return the proper rigid motion by which points fit a shape best, from any pose.

    Six points far apart make twenty triangles. Each is laid on the triangles of the shape whose
    sides are as long to within the width, the 150 most alike of them; and so are twenty of the
    shape on those of the points. Each such pose is rated by the mean squared distance from one
    of those that are fewer, points or places, to the nearest of the others, none counting more
    than ``width^2``. The sixteen best are refined by `closest`, from a width twice as large; the
    best of those is returned. Points that are at no place, and places without a point, do not
    matter as long as some triangle is free of them. A mirror image is never tried: a
    face differs from its mirror image in depth only.

    Parameters
    ----------
    points
        (P, 3) mm, three at least.
    shape
        (M, 3) mm, in no particular order.
    width
        Millimetres; points that are farther from their places hardly count.

    Returns
    -------
    Match or None
        None where no triangle is like another.
    """
    poses = _poses(points, shape, width)
    best = np.argsort(_rates(poses, points, shape, width), kind="stable")[:_REFINED]
    matches = [
        closest(points, shape, poses.rotations[pose], poses.translations[pose], width, widest=2.0)
        for pose in best
    ]
    return min(matches, key=lambda match: match.cost, default=None)


def closest(
    points: NDArray[np.float64],
    shape: NDArray[np.float64],
    rotation: NDArray[np.float64],
    translation: NDArray[np.float64],
    width: float,
    *,
    widest: float = 1.0,
) -> Match:
    """Return the best fit near a pose, by iterative closest points (Besl & McKay).

    In turns, points are assigned to places so that the sum of their squared distances is least,
    none counting more than the squared width, and the pose is fitted robustly to those within
    it. No point and no place is used twice.

    Parameters
    ----------
    points, shape, width
        As for `register`.
    rotation, translation
        Where to begin: ``R p + t``.
    widest
        Times the width, from which it comes down to it.
    """
    reach = widest * width
    previous: tuple[bytes, float] = (b"", 0.0)
    for _ in range(_STEPS):
        point, place = _assigned(points @ rotation.T + translation, shape, reach)
        if (now := (point.tobytes() + place.tobytes(), reach)) == previous or len(point) < 3:
            break
        pose = _pose(points[point], shape[place], reach)
        if not pose.known[0]:
            break
        rotation, translation = pose.rotations[0], pose.translations[0]
        previous, reach = now, max(width, 0.7 * reach)
    distances = np.linalg.norm(points[point] @ rotation.T + translation - shape[place], axis=1)
    near = distances <= width
    lost = (len(shape) - np.count_nonzero(near)) * width**2
    cost = float(((distances[near] ** 2).sum() + lost) / len(shape))
    return Match(rotation, translation, point[near], place[near], cost)


def _assigned(
    points: NDArray[np.float64], shape: NDArray[np.float64], reach: float
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial.distance import cdist

    squared = cdist(points, shape, "sqeuclidean")
    point, place = linear_sum_assignment(np.minimum(squared, reach**2))
    near = squared[point, place] < reach**2
    return point[near], place[near]


def _pose(points: NDArray[np.float64], places: NDArray[np.float64], width: float) -> RigidMotions:
    used = np.ones((1, len(points)), dtype=np.bool_)
    return fit_robustly(points[np.newaxis], places, used, width=width)


def _poses(points: NDArray[np.float64], shape: NDArray[np.float64], width: float) -> RigidMotions:
    """Return the poses in which triangles lie on triangles like them, from either side."""
    there, back = _laid(points, shape, width), _inverse(_laid(shape, points, width))
    return RigidMotions(*(np.concatenate(part) for part in zip(there, back, strict=True)))


def _laid(source: NDArray[np.float64], target: NDArray[np.float64], width: float) -> RigidMotions:
    """Return the poses that lay far triangles of the source on those of the target."""
    from itertools import combinations

    apart = np.linalg.norm(target[:, np.newaxis] - target, axis=2)
    ends = []
    for corners in combinations(far_apart(source, _CORNERS), 3):
        triangle = source[list(corners)]
        alike = _alike(triangle, apart, width)
        ends.append((np.broadcast_to(triangle, (len(alike), 3, 3)), target[alike]))
    first, second = (np.concatenate(part) for part in zip(*ends, strict=True))
    return fit(first, second, np.ones((len(first), 3)))


def _inverse(poses: RigidMotions) -> RigidMotions:
    back = poses.rotations.transpose(0, 2, 1)
    return RigidMotions(back, -(back @ poses.translations[..., np.newaxis])[..., 0], poses.known)


def _rates(
    poses: RigidMotions, points: NDArray[np.float64], shape: NDArray[np.float64], width: float
) -> NDArray[np.float64]:
    from scipy.spatial import KDTree

    if len(points) > len(shape):
        return _rates(_inverse(poses), shape, points, width)
    tree, rates = KDTree(shape), [np.empty(0)]
    for start in range(0, len(poses.known), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        some = RigidMotions(poses.rotations[part], poses.translations[part], poses.known[part])
        nearest, _ = tree.query(some.apply(points), distance_upper_bound=width)
        rates.append((np.minimum(nearest, width) ** 2).mean(axis=1))
    return np.concatenate(rates)


def _alike(
    triangle: NDArray[np.float64], apart: NDArray[np.float64], width: float
) -> NDArray[np.intp]:
    """Return (N, 3): which places, in this order, make a triangle with sides as long."""
    first_side, two, three = np.linalg.norm(triangle - np.roll(triangle, -1, axis=0), axis=1)
    first, second = np.nonzero(
        (np.abs(apart - first_side) < width) & ~np.eye(len(apart), dtype=np.bool_)
    )
    errors = np.maximum(np.abs(apart[second] - two), np.abs(apart[first] - three))
    errors = np.maximum(errors, np.abs(apart[first, second] - first_side)[:, np.newaxis])
    row, third = np.nonzero(errors < width)
    best = np.argsort(errors[row, third], kind="stable")[:_ALIKE]
    return np.stack([first[row], second[row], third], axis=1)[best]
