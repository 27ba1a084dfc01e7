"""The plane in which a shape mirrors itself best: partners across it, left and right, up, front."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_mocap.spread import far_apart

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

ALONE = -1
_CORNERS, _REFINED, _STEPS = 12, 12, 30


class Mirror(NamedTuple):
    """The plane of the points x with ``normal @ x = offset``; the normal has length 1."""

    normal: NDArray[np.float64]
    offset: float

    def signed(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the signed distance of points from the plane, mm."""
        return np.asarray(points @ self.normal - self.offset)

    def reflect(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mirror images of points."""
        return points - 2.0 * self.signed(points)[..., np.newaxis] * self.normal

    def distances(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (N, N): from each point to the mirror image of each; symmetric."""
        images = self.reflect(points)
        return np.asarray(np.linalg.norm(points[:, np.newaxis] - images, axis=2))


def find_mirror(points: NDArray[np.float64], width: float) -> Mirror:
    """Return the plane across which the points find partners best.

    Twelve points far apart, each with every other point, make the planes to begin with: those
    that mirror the one point onto the other. They are compared by the mean squared distance from
    a point to the nearest mirror image, none counting more than ``width^2``, over the variance
    of the points across the plane: else a plane in which a flat shape lies would always do. The
    twelve best are refined as by iterative closest points: partners by optimal assignment, then
    the plane that suits the partners best, far ones counting little; the best of those is
    returned. Points without a partner do not matter as long as one of the twelve has one.

    Parameters
    ----------
    points
        (N, 3) mm, not on a plane.
    width
        Millimetres; partners that are farther apart hardly count.
    """
    starts = _planes(points)
    best = np.argsort(_costs(points, starts, width), kind="stable")[:_REFINED]
    refined = [_refined(points, starts[index], width) for index in best]
    return refined[int(np.argmin(_costs(points, refined, width)))]


def partners(points: NDArray[np.float64], mirror: Mirror, tolerance: float) -> NDArray[np.intp]:
    """Return each point's partner: another's number, its own on the plane, or -1 for none.

    Partners are mutual. They minimize the sum of squared distances from points to the mirror
    images of their partners, a point without one costing ``tolerance^2``: a matching of maximum
    weight, in which no distance exceeds the tolerance.

    Parameters
    ----------
    points
        (N, 3) mm.
    mirror
        The plane.
    tolerance
        Millimetres.
    """
    import networkx as nx

    distances = mirror.distances(points)
    own = np.minimum(np.diagonal(distances), tolerance) ** 2
    gain = own[:, np.newaxis] + own - 2.0 * distances**2
    graph: nx.Graph[int] = nx.Graph()
    for first, second in np.argwhere(np.triu((distances <= tolerance) & (gain > 0), 1)).tolist():
        graph.add_edge(first, second, weight=float(gain[first, second]))
    partner = np.where(np.diagonal(distances) <= tolerance, np.arange(len(points)), ALONE)
    for first, second in nx.max_weight_matching(graph):
        partner[first], partner[second] = second, first
    return partner


def _planes(points: NDArray[np.float64]) -> list[Mirror]:
    """Return the planes half way between some points and every other one, across their line."""
    planes = []
    for corner in far_apart(points, _CORNERS):
        apart = points - points[corner]
        lengths = np.linalg.norm(apart, axis=1)
        for other in np.flatnonzero(lengths):
            normal = apart[other] / lengths[other]
            middle = (points[corner] + points[other]) / 2.0
            planes.append(Mirror(normal, float(normal @ middle)))
    return planes


def _costs(points: NDArray[np.float64], planes: list[Mirror], width: float) -> NDArray[np.float64]:
    from scipy.spatial import KDTree

    tree = KDTree(points)
    images = (plane.reflect(points) for plane in planes)
    nearest = np.array([tree.query(image, distance_upper_bound=width)[0] for image in images])
    spread = np.var(points @ np.transpose([plane.normal for plane in planes]), axis=0)
    errors = np.mean(np.minimum(nearest, width) ** 2, axis=1)
    return np.asarray(errors / np.maximum(spread, np.finfo(float).tiny))


def _refined(points: NDArray[np.float64], plane: Mirror, width: float) -> Mirror:
    from scipy.optimize import linear_sum_assignment

    assigned: NDArray[np.intp] | None = None
    for _ in range(_STEPS):
        distances = plane.distances(points)
        _, partner = linear_sum_assignment(np.minimum(distances, 3 * width) ** 2)
        weights = 1.0 / (1.0 + (distances[np.arange(len(points)), partner] / width) ** 2) ** 2
        plane = _suited(points, points[partner], weights)
        if assigned is not None and np.array_equal(assigned, partner):
            break
        assigned = partner
    return plane


def _suited(
    points: NDArray[np.float64], images: NDArray[np.float64], weights: NDArray[np.float64]
) -> Mirror:
    """Return the plane that minimizes ``sum(w |p - reflect(q)|^2)``.

    With both at their common centroid the sum is ``sum(w |p - q|^2) + 4 n' B n``, where B is
    the symmetric part of ``sum(w p q')``: n is the eigenvector of its smallest eigenvalue.
    """
    share = weights / weights.sum()
    centre = share @ (points + images) / 2.0
    product = (share[:, np.newaxis] * (points - centre)).T @ (images - centre)
    normal = np.linalg.eigh(product + product.T)[1][:, 0]
    return Mirror(normal, float(normal @ centre))


class FaceAxes(NamedTuple):
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
) -> FaceAxes:
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
    return FaceAxes(across, up, front)


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
