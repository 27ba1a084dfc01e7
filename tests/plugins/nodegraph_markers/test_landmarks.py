"""Landmarks are the markers that move least, pairs as a whole, never on a line."""

from __future__ import annotations

import numpy as np

from nodegraph_markers.infer import still_landmarks

ALONE = np.full(24, -1)
SHAPE = np.random.default_rng(0).normal(0.0, 40.0, (24, 3))


def test_a_sixth_that_moves_least() -> None:
    motion = np.arange(24.0)[::-1]
    assert still_landmarks(SHAPE, motion, ALONE) == [20, 21, 22, 23]


def test_a_pair_counts_with_its_livelier_half_and_comes_as_a_whole() -> None:
    motion, partner = np.arange(24.0), ALONE.copy()
    partner[[0, 23]] = 23, 0
    assert still_landmarks(SHAPE, motion, partner) == [1, 2, 3, 4]
    partner[[4, 3]], partner[[5, 4]] = [3, 4], [4, 5]
    partner[3], partner[4], partner[5] = -1, 5, 4
    assert still_landmarks(SHAPE, motion, partner) == [1, 2, 3, 4, 5]


def test_more_are_taken_while_they_lie_on_a_line() -> None:
    shape = SHAPE.copy()
    shape[:6] = np.linspace([0.0, 0, 0], [0, 100, 1], 6)
    assert still_landmarks(shape, np.arange(24.0), ALONE) == [0, 1, 2, 3, 4, 5, 6]
