"""The shortest of weights that do the same, beside every choice of bound ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph_blendshapes.solve.share_kernel import ENOUGH, share
from tests.plugins.nodegraph_blendshapes.solve.statements import Matrix, least_norm

INF = float("inf")


def shared(projector: Matrix, weights: Matrix, low: Matrix, high: Matrix) -> tuple[Matrix, bool]:
    solution, done = np.empty((1, len(weights))), np.empty(1, dtype=bool)
    share(projector, (weights @ projector)[None], low[None], high[None], solution, done)
    return solution[0], bool(done[0])


def orthonormal(seed: int, shapes: int, rank: int) -> Matrix:
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(shapes, rank)))[0]


@pytest.mark.parametrize(("low", "high"), [(0.0, 1.0), (-0.5, 1.0), (0.0, INF)])
@given(seed=st.integers(0, 10**6), shapes=st.integers(2, 5), at_bounds=st.booleans())
def test_the_shortest(low: float, high: float, seed: int, shapes: int, at_bounds: bool) -> None:
    random = np.random.default_rng(seed)
    projector = orthonormal(seed, shapes, int(random.integers(1, shapes)))
    weights = random.uniform(low, min(high, 2.0), shapes)
    if at_bounds:
        weights[random.random(shapes) < 0.5] = low
    lows, highs = np.full(shapes, low), np.full(shapes, high)
    solution, done = shared(projector, weights, lows, highs)
    if done:
        apart = np.abs((solution - weights) @ projector).max()
        assert apart <= ENOUGH * np.linalg.norm(weights @ projector)
        assert low <= solution.min()
        assert solution.max() <= high
        shortest = least_norm(projector, weights, low, high)
        np.testing.assert_allclose(solution @ solution, shortest @ shortest, rtol=1e-6, atol=1e-9)
    assert done or at_bounds


def test_what_no_weights_give_is_not_done() -> None:
    projector = orthonormal(0, 6, 3)
    solution, done = np.empty((1, 6)), np.ones(1, dtype=bool)
    share(projector, np.full((1, 3), 50.0), np.zeros((1, 6)), np.ones((1, 6)), solution, done)
    assert not done[0]
