"""Zhang et al.: three neighbours, weighted by a power of a cosine."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_fill.muscle import muscle
from nodegraph_mocap import Trajectories
from tests.plugins.nodegraph_fill.plain_fills import run_plainly
from tests.plugins.recordings import make_gappy, quietly


def weigh(distances: list[float]) -> list[float]:
    if len(distances) == 1:
        return [1.0]
    if len(distances) == 2:
        inverse = [1 / distance for distance in distances]
        return [value / sum(inverse) for value in inverse]
    return [((1 + math.cos(math.pi * d / sum(distances))) / 2) ** 4 for d in distances]


def weigh_normalized(distances: list[float]) -> list[float]:
    weights = weigh(distances)
    return [weight / sum(weights) for weight in weights]


@given(
    seed=st.integers(0, 2**32 - 1),
    normalize=st.booleans(),
    use_filled=st.booleans(),
    close_gap=st.sampled_from(["none", "ramp", "blend"]),
    max_gap=st.sampled_from([None, 1, 4]),
)
def test_equals_the_plain_statement(
    seed: int, normalize: bool, use_filled: bool, close_gap: str, max_gap: int | None
) -> None:
    recording = make_gappy(seed)
    shared: dict[str, Any] = {"use_filled": use_filled, "close_gap": close_gap, "max_gap": max_gap}
    filled = quietly(muscle, recording, normalize=normalize, **shared)
    plain = run_plainly(recording, weigh_normalized if normalize else weigh, neighbours=3, **shared)
    np.testing.assert_allclose(filled.positions, plain, rtol=0, atol=1e-9)


def moved_by_one(places: list[list[float]], *, normalize: bool = False) -> Any:
    """Where marker 0, missing in frame 1, goes when each of the others moves by (1, 0, 0)."""
    positions = np.array([places, places], dtype=float)
    positions[1, 1:, 0] += 1
    positions[1, 0] = np.nan
    names = tuple("abcd"[: len(places)])
    recording = Trajectories(positions=positions, markers=names, rate=60.0)
    return muscle(recording, normalize=normalize).positions[1, 0] - positions[0, 0]


@pytest.mark.parametrize(
    ("places", "total"),
    [
        ([[0, 0, 0], [0, 5, 0], [0, 0, 5], [0, -5, 0]], 243 / 256),
        ([[0, 0, 0], [0, 0, 0], [0, 1, 0], [0, 0, 1]], 1.125),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 1]], 2.0),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]], 1.0),
        ([[0, 0, 0], [0, 3, 0], [0, 0, 4]], 1.0),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 0]], 1.0),
        ([[0, 0, 0], [0, 0, 0], [0, 0, 4]], 1.0),
        ([[0, 0, 0], [0, 3, 0]], 1.0),
        ([[0, 0, 0], [0, 0, 0]], 1.0),
    ],
)
def test_the_sum_of_the_weights(places: list[list[float]], total: float) -> None:
    np.testing.assert_allclose(moved_by_one(places), [total, 0, 0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(moved_by_one(places, normalize=True), [1, 0, 0], rtol=0, atol=1e-15)
