"""Several fills, averaged by how plausible each is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph import Across
from nodegraph_combine.ensemble import ensemble
from nodegraph_mocap import Trajectories

Filled = Callable[[list[float]], Across[Trajectories]]


def plainly(truth: Trajectories, fills: Across[Trajectories], neighbours: int) -> float:
    """The share of the second fill in the gap of marker b, from the formula."""
    known = [t for t in range(40) if not 10 <= t < 20]
    usual = []
    for other in (0, 2, 3, 4):
        apart = [
            float(np.linalg.norm(truth.positions[t, 1] - truth.positions[t, other])) for t in known
        ]
        mean = sum(apart) / len(apart)
        spread = (sum((value - mean) ** 2 for value in apart) / len(apart)) ** 0.5
        usual.append((spread / mean, other, mean, max(spread, mean / 1000)))
    weights = []
    for fill in fills.values():
        squared = [
            ((np.linalg.norm(fill.positions[t, 1] - fill.positions[t, other]) - mean) / spread) ** 2
            for t in range(10, 20)
            for _, other, mean, spread in sorted(usual)[:neighbours]
        ]
        weights.append(np.exp(-sum(squared) / len(squared) / 2))
    return float(weights[1] / sum(weights))


@pytest.mark.parametrize("neighbours", [1, 3, 9])
def test_equals_the_plain_formula(filled: Filled, truth: Trajectories, neighbours: int) -> None:
    fills = filled([0.02, 0.12])
    combined = ensemble(fills, neighbours=neighbours)
    share = plainly(truth, fills, neighbours)
    assert 0.01 < share < 0.99
    off = combined.positions[10:20, 1, 0] - truth.positions[10:20, 1, 0]
    np.testing.assert_allclose(off, 0.02 + share * 0.1, atol=1e-9)


def test_a_fill_that_breaks_all_distances_has_no_say(filled: Filled, truth: Trajectories) -> None:
    combined = ensemble(filled([0.0, 50.0, -80.0]))
    np.testing.assert_allclose(combined.positions, truth.positions, atol=1e-9)


def test_of_implausible_fills_the_least_one_counts(filled: Filled, truth: Trajectories) -> None:
    combined = ensemble(filled([3000.0, 9000.0]))
    off = combined.positions[10:20, 1, 0] - truth.positions[10:20, 1, 0]
    np.testing.assert_allclose(off, 3000.0, atol=1e-6)


def test_without_neighbours_all_count_alike(filled: Filled, truth: Trajectories) -> None:
    alone = {str(i): take.keep("b") for i, take in enumerate(filled([1.0, 3.0]).values())}
    combined = ensemble(Across.of(alone, axis="fill"))
    off = combined.positions[10:20, 0, 0] - truth.positions[10:20, 1, 0]
    np.testing.assert_allclose(off, 2.0, atol=1e-12)


def test_a_fill_alone_in_a_frame_counts_whole(filled: Filled, truth: Trajectories) -> None:
    combined = ensemble(filled([np.nan, 70.0]))
    off = combined.positions[10:20, 1, 0] - truth.positions[10:20, 1, 0]
    np.testing.assert_allclose(off, 70.0, atol=1e-9)
