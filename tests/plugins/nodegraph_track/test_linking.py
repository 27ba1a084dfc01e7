"""Links are those that a plain search over all of them finds."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_track.linking import assign, take_nearest


def scene(seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    random = np.random.default_rng(seed)
    points = random.uniform(0, 4, (random.integers(0, 6), 3))
    return random.uniform(0, 4, (random.integers(0, 6), 3)), points[np.argsort(points[:, 0])]


def cost(squared: NDArray[np.float64], links: set[tuple[int, int]], gate: float) -> float:
    return float(sum(squared[link] for link in links) + gate**2 * (len(squared) - len(links)))


def cheapest(squared: NDArray[np.float64], gate: float) -> float:
    places, points = squared.shape
    found = []
    for choice in itertools.product(range(-1, points), repeat=places):
        links = {(row, column) for row, column in enumerate(choice) if column >= 0}
        once = len({column for _, column in links}) == len(links)
        if once and all(squared[link] <= gate**2 for link in links):
            found.append(cost(squared, links, gate))
    return min(found)


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("gate", [1.0, 2.0, 10.0])
def test_an_assignment_costs_as_little_as_can_be(seed: int, gate: float) -> None:
    places, points = scene(seed)
    squared = ((places[:, None] - points) ** 2).sum(axis=2)
    place, point = assign(places, points, gate)
    assert len(set(place)) == len(place) == len(set(point))
    links = set(zip(place.tolist(), point.tolist(), strict=True))
    assert all(squared[link] <= gate**2 for link in links)
    assert cost(squared, links, gate) == pytest.approx(cheapest(squared, gate))


@pytest.mark.parametrize("seed", range(20))
def test_without_a_gate_as_many_are_linked_as_can_be(seed: int) -> None:
    places, points = scene(seed)
    place, _ = assign(places, points, np.inf)
    assert len(place) == min(len(places), len(points))


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("gate", [1.0, 2.0, np.inf])
def test_the_nearest_pair_is_linked_first(seed: int, gate: float) -> None:
    places, points = scene(seed)
    apart = np.linalg.norm(places[:, None] - points, axis=2)
    expected = set()
    while apart.size and apart.min() <= min(gate, 1e9):
        row, column = np.unravel_index(apart.argmin(), apart.shape)
        expected.add((int(row), int(column)))
        apart[row] = apart[:, column] = np.inf
    place, point = take_nearest(places, points, gate)
    assert set(zip(place.tolist(), point.tolist(), strict=True)) == expected
