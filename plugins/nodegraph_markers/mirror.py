"""The plane in which a shape mirrors itself best, and each point's partner across it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from nodegraph_markers.rigid import far_apart

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
