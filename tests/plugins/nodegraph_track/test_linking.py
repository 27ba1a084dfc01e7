"""Links are those that a plain search over all of them finds."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from nodegraph_track.linking_kernel import assigned, nearest_first


def scene(seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    random = np.random.default_rng(seed)
    points = random.uniform(0, 4, (random.integers(0, 6), 3))
    return random.uniform(0, 4, (random.integers(0, 6), 3)), points[np.argsort(points[:, 0])]


def assign(
    places: NDArray[np.float64],
    points: NDArray[np.float64],
    gate: float,
    *otherwise: NDArray[np.float64],
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return pairs(assigned(np.array([places, *otherwise]), points, gate))


def pairs(of_place: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    place = np.flatnonzero(of_place >= 0)
    return place, of_place[place]


def cost(squared: NDArray[np.float64], links: set[tuple[int, int]], gate: float) -> float:
    return float(sum(squared[link] for link in links) + gate**2 * (len(squared) - len(links)))


def cheapest(squared: NDArray[np.float64], gate: float) -> float:
    places, points = squared.shape
    pieces = []
    for choice in itertools.product(range(-1, points), repeat=places):
        links = {(row, column) for row, column in enumerate(choice) if column >= 0}
        once = len({column for _, column in links}) == len(links)
        if once and all(squared[link] <= gate**2 for link in links):
            pieces.append(cost(squared, links, gate))
    return min(pieces)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("gate", [1.0, 2.0, 10.0])
def test_an_assignment_costs_as_little_as_can_be(seed: int, gate: float) -> None:
    places, points = scene(seed)
    squared = ((places[:, None] - points) ** 2).sum(axis=2)
    place, point = assign(places, points, gate)
    assert len(set(place)) == len(place) == len(set(point))
    links = set(zip(place.tolist(), point.tolist(), strict=True))
    assert all(squared[link] <= gate**2 for link in links)
    assert cost(squared, links, gate) == pytest.approx(cheapest(squared, gate))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("gate", [0.7, 1.5, np.inf])
def test_many_cost_as_little_as_scipy_makes_them(seed: int, gate: float) -> None:
    random = np.random.default_rng(seed)
    places, points = (random.uniform(0, 4, (random.integers(20, 40), 3)) for _ in range(2))
    points = points[np.argsort(points[:, 0])]
    squared = ((places[:, None] - points) ** 2).sum(axis=2)
    alone = gate**2 if np.isfinite(gate) else 1e6
    saved = np.minimum(squared - alone, 0.0)
    expected = saved[linear_sum_assignment(saved)].sum()
    place, point = assign(places, points, gate)
    assert len(set(place)) == len(place) == len(set(point))
    assert saved[place, point].sum() == pytest.approx(expected)


def test_those_without_a_point_are_looked_for_elsewhere() -> None:
    points = np.array([[0.0, 0, 0], [4, 0, 0], [9, 0, 0]])
    places = np.array([[0.5, 0, 0], [6.5, 0, 0], [20, 0, 0]])
    first, second = places + [[2, 0, 0]] * 3, np.array([[0.0, 0, 0], [4, 0, 0], [8, 0, 0]])
    assert links_of(assign(places, points, 1.0)) == {(0, 0)}
    assert links_of(assign(places, points, 1.0, first)) == {(0, 0), (1, 2)}
    # what has a point keeps it, and nobody else gets it
    assert links_of(assign(places, points, 1.0, second[::-1])) == {(0, 0), (1, 1)}
    assert links_of(assign(places, points, 1.0, first, second)) == {(0, 0), (1, 2)}


def links_of(pairs: tuple[NDArray[np.intp], NDArray[np.intp]]) -> set[tuple[int, int]]:
    return set(zip(*(part.tolist() for part in pairs), strict=True))


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("gate", [1.0, 2.0, np.inf])
def test_the_nearest_pair_is_linked_first(seed: int, gate: float) -> None:
    places, points = scene(seed)
    apart = np.linalg.norm(places[:, None] - points, axis=2)
    expected = set()
    while apart.size and apart.min() <= min(gate, 1e9):
        row, column = np.unravel_index(apart.argmin(), apart.shape)
        expected.add((int(row), int(column)))
        apart[row] = apart[:, column] = np.inf
    place, point = pairs(nearest_first(places, points, gate))
    assert set(zip(place.tolist(), point.tolist(), strict=True)) == expected
