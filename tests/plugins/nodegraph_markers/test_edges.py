"""Lines to draw join neighbours, and span no hollow."""

from __future__ import annotations

import numpy as np

from nodegraph_markers.infer import edges_of


def test_a_square_lattice_is_joined_by_its_sides_and_one_diagonal_each() -> None:
    across, up = np.meshgrid(np.arange(5.0), np.arange(4.0))
    plane = np.stack([across.ravel(), up.ravel()], axis=1)
    edges = edges_of(plane)
    lengths = [np.linalg.norm(plane[first] - plane[second]) for first, second in edges]
    assert sum(np.isclose(lengths, 1.0)) == 5 * 3 + 4 * 4
    assert sum(np.isclose(lengths, np.sqrt(2))) == 4 * 3
    assert edges == sorted(edges)
    assert all(first < second for first, second in edges)


def test_a_hollow_of_the_outline_is_not_spanned() -> None:
    angles = np.linspace(0, np.pi, 19)
    ring = np.concatenate(
        [radius * np.stack([np.cos(angles), np.sin(angles)], 1) for radius in (9, 10)]
    )
    edges = edges_of(ring)
    assert max(np.linalg.norm(ring[first] - ring[second]) for first, second in edges) < 2.5
    assert {end for edge in edges for end in edge} == set(range(38))
