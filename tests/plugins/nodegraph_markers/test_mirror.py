"""The plane of symmetry is found, however a shape is turned, with each point's partner."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_markers.mirror import Mirror, find_mirror, partners


def symmetric(pairs: int, middle: int, seed: int) -> tuple[NDArray[np.float64], list[int]]:
    """Return a shape that mirrors itself in x = 0, and the partner of each point."""
    random = np.random.default_rng(seed)
    side = random.uniform([12, -90, -20], [60, 90, 30], (pairs, 3))
    centre = random.uniform([0, -90, 0], [0, 90, 40], (middle, 3))
    partner = [*range(pairs, 2 * pairs), *range(pairs), *range(2 * pairs, 2 * pairs + middle)]
    return np.concatenate([side, side * [-1.0, 1.0, 1.0], centre]), partner


@pytest.mark.parametrize("seed", range(4))
def test_the_plane_is_found_in_any_pose(seed: int) -> None:
    shape, _ = symmetric(12, 5, seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    moved = shape @ turn.T + [300.0, -20.0, 70.0]
    mirror = find_mirror(moved, 8.0)
    np.testing.assert_allclose(abs(mirror.normal @ turn[:, 0]), 1.0, atol=1e-9)
    assert np.abs(mirror.signed(moved[-5:])).max() < 1e-6


@pytest.mark.parametrize("seed", range(4))
def test_points_without_a_partner_hardly_move_the_plane(seed: int) -> None:
    shape, _ = symmetric(12, 5, seed)
    shape = shape + np.random.default_rng(seed).normal(0.0, 0.5, shape.shape)
    some = np.delete(shape, [0, 3, 7], axis=0)  # three whose partners stay behind
    normal = find_mirror(some, 8.0).normal
    assert abs(normal[0]) > np.cos(np.radians(2))


@pytest.mark.parametrize("seed", range(5))
def test_partners_are_the_best_of_all_matchings(seed: int) -> None:
    random = np.random.default_rng(seed)
    shape, _ = symmetric(2, 2, seed)
    shape = shape + random.normal(0.0, 6.0, shape.shape)
    mirror, tolerance = Mirror(np.array([1.0, 0, 0]), 0.0), 25.0
    distances = mirror.distances(shape)

    def cost(partner: tuple[int, ...] | NDArray[np.intp]) -> float:
        every = [
            distances[first, second] ** 2 for first, second in enumerate(partner) if second >= 0
        ]
        alone = sum(two < 0 for two in partner)
        near = all(cost <= tolerance**2 for cost in every)
        return sum(every) + alone * tolerance**2 if near else np.inf

    best = min(
        cost(tuple(-1 if alone >> first & 1 else second for first, second in enumerate(order)))
        for order in permutations(range(6))
        if all(order[second] == first for first, second in enumerate(order))
        for alone in range(64)
        if all(alone >> first & 1 == alone >> second & 1 for first, second in enumerate(order))
    )
    assert cost(partners(shape, mirror, tolerance)) == pytest.approx(best)


def test_what_is_farther_than_the_tolerance_has_no_partner() -> None:
    shape = np.array([[30.0, 0, 0], [-30, 0, 9], [0, 50, 0], [4, -50, 0], [5, 80, 0]])
    partner = partners(shape, Mirror(np.array([1.0, 0, 0]), 0.0), 8.5)
    assert partner.tolist() == [-1, -1, 2, 3, -1]
