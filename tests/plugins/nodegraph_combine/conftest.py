"""Several fills of one recording."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from nodegraph import Across
from nodegraph_mocap import Origin, Trajectories

Filled = Callable[[list[float]], Across[Trajectories]]


@pytest.fixture
def truth() -> Trajectories:
    """Five markers that keep their distances, but for a little."""
    random = np.random.default_rng(5)
    places = random.normal(0, 20, (5, 3))
    walk = np.cumsum(random.normal(0, 1, (40, 1, 3)), axis=0)
    positions = places + walk + random.normal(0, 0.05, (40, 5, 3))
    return Trajectories(positions=positions, markers=tuple("abcde"), rate=60.0)


@pytest.fixture
def filled(truth: Trajectories) -> Filled:
    """Fills of a gap (marker b, frames 10 to 19), each off by a distance; NaN: not filled."""

    def make(errors: list[float]) -> Across[Trajectories]:
        gap = np.zeros(truth.origin.shape, dtype=np.bool_)
        gap[10:20, 1] = True
        fills = {}
        for index, error in enumerate(errors):
            positions = truth.positions.copy()
            positions[10:20, 1] += [error, 0.0 * error, 0.0 * error]
            fills[f"f{index}"] = truth.with_samples(positions, changed=gap, origin=Origin.FILLED)
        return Across.of(fills, axis="fill")

    return make
