"""A few points stand for all, far apart."""

from __future__ import annotations

import numpy as np

from nodegraph_markers.spread import far_apart


def test_each_is_the_farthest_from_those_before() -> None:
    points = np.random.default_rng(0).normal(0.0, 40.0, (50, 3))
    chosen = far_apart(points, 6)
    assert len(set(chosen)) == 6
    assert chosen[0] == np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1))
    for count in range(1, 6):
        apart = np.linalg.norm(points[:, None] - points[chosen[:count]], axis=2).min(axis=1)
        assert chosen[count] == np.argmax(apart)


def test_all_of_few() -> None:
    assert sorted(far_apart(np.eye(3), 6)) == [0, 1, 2]
