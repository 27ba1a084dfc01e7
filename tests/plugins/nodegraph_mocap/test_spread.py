"""Points from which a search begins lie far apart."""

from __future__ import annotations

import numpy as np

from nodegraph_mocap.spread import far_apart


def test_each_point_far_apart_is_the_farthest_from_those_before() -> None:
    points = np.random.default_rng(0).normal(0.0, 40.0, (50, 3))
    numbers = far_apart(points, 6)
    assert len(set(numbers)) == 6
    assert numbers[0] == np.argmax(np.linalg.norm(points - points.mean(axis=0), axis=1))
    for count in range(1, 6):
        apart = np.linalg.norm(points[:, None] - points[numbers[:count]], axis=2).min(axis=1)
        assert numbers[count] == np.argmax(apart)
