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


def test_the_triangles_mirror_each_other() -> None:
    surface = make_surface(Proportions())
    columns = 2 * HALF_COLUMNS + 1
    row, column = np.divmod(surface.faces, columns)
    mirrored = row * columns + (columns - 1 - column)
    here = {frozenset(face) for face in surface.faces.tolist()}
    assert {frozenset(face) for face in mirrored.tolist()} == here


@pytest.mark.parametrize("surface", _surfaces())
def test_the_face_is_seen_from_the_front_without_folds(surface: Surface) -> None:
    corners = surface.vertices[surface.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] > 0).all()


def test_the_average_face_has_the_size_of_a_face() -> None:
    vertices = make_surface(Proportions()).vertices
    width, height, depth = np.ptp(vertices, axis=0)
    assert 130 < width < 150
    assert 180 < height < 200
    # From the tip of the nose to the front of the ears.
    assert 110 < depth < 130
    tip = vertices[vertices[:, 2].argmax()]
    assert tip[0] == 0.0
    assert abs(tip[1]) < 6.0


def test_no_triangle_joins_the_lips() -> None:
    surface = make_surface(Proportions())
    corners = surface.vertices[surface.faces]
    above = (corners[..., 1] > MOUTH_HEIGHT).any(axis=1)
    below = (corners[..., 1] < MOUTH_HEIGHT).any(axis=1)
    across = corners[above & below]
    assert len(across) > 0
    assert (np.abs(across[..., 0]).max(axis=1) > 25.0).all()


def test_actors_have_other_proportions() -> None:
    first, other = (draw_proportions(np.random.default_rng(seed)) for seed in (1, 2))
    assert first != other
    assert min(first.width, other.width, first.height, other.height) >= 0.9
