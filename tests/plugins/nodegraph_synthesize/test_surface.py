from __future__ import annotations

import numpy as np
import pytest

from nodegraph_synthesize.proportions import MOUTH_HEIGHT, Proportions, draw_proportions
from nodegraph_synthesize.surface import HALF_COLUMNS, Surface, make_surface


def _surfaces() -> list[Surface]:
    drawn = [draw_proportions(np.random.default_rng(seed)) for seed in range(5)]
    return [make_surface(proportions) for proportions in (Proportions(), *drawn)]


@pytest.mark.parametrize("surface", _surfaces())
def test_left_and_right_mirror_each_other_exactly(surface: Surface) -> None:
    rows = surface.vertices.reshape(-1, 2 * HALF_COLUMNS + 1, 3)
    np.testing.assert_array_equal(rows[:, ::-1] * [-1.0, 1.0, 1.0], rows)


@pytest.mark.parametrize("surface", _surfaces())
def test_the_face_is_seen_from_the_front_without_folds(surface: Surface) -> None:
    corners = surface.vertices[surface.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0).all()


def test_no_triangle_joins_the_lips() -> None:
    surface = make_surface(Proportions())
    corners = surface.vertices[surface.faces]
    above = (corners[..., 1] > MOUTH_HEIGHT).any(axis=1)
    below = (corners[..., 1] < MOUTH_HEIGHT).any(axis=1)
    across = corners[above & below]
    assert len(across) > 0
    assert (np.abs(across[..., 0]).max(axis=1) > 25.0).all()
