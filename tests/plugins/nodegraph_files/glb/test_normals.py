from __future__ import annotations

import numpy as np

from nodegraph_files.glb.writing import vertex_normals
from nodegraph_mocap import Head
from nodegraph_mocap.specimens import heads

HEAD = heads()["complete"]
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
"""Counter-clockwise as seen from outside."""


def plainly(head: Head, vertex: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The mean normal of a vertex's triangles, each as often as it is large."""
    total = np.zeros(3)
    for face in head.faces:
        if vertex in face:
            first, second, third = head.vertices[face]
            turned = np.cross(second - first, third - first)
            area = np.linalg.norm(turned) / 2
            total += area * turned / np.linalg.norm(turned)
    return total / np.linalg.norm(total)


def test_normals_are_the_mean_of_a_vertex_s_triangles_by_area() -> None:
    normals = vertex_normals(HEAD.vertices, HEAD.faces)
    for vertex in np.unique(HEAD.faces):
        np.testing.assert_allclose(normals[vertex], plainly(HEAD, vertex), atol=1e-12)


def test_normals_point_outward() -> None:
    normals = vertex_normals(CORNERS, TETRAHEDRON)
    middle = CORNERS.mean(axis=0)
    assert np.all(np.einsum("vi,vi->v", normals, CORNERS - middle) > 0)
    np.testing.assert_allclose(normals[0], -np.ones(3) / np.sqrt(3))


def test_those_of_a_sphere_are_its_radii() -> None:
    import trimesh

    sphere = trimesh.creation.icosphere(subdivisions=3)
    normals = vertex_normals(np.array(sphere.vertices), np.array(sphere.faces))
    np.testing.assert_allclose(normals, sphere.vertices, atol=0.02)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, rtol=1e-12)


def test_a_vertex_without_a_triangle_gets_what_is_given() -> None:
    vertices = np.vstack([CORNERS, [5.0, 5, 5]])
    flat = np.array([[0, 1, 1]])
    np.testing.assert_array_equal(vertex_normals(vertices, flat), np.tile([0.0, 0, 1], (5, 1)))
    given = np.tile([0.0, 0, -1], (5, 1))
    normals = vertex_normals(vertices, TETRAHEDRON, otherwise=given)
    np.testing.assert_array_equal(normals[4], given[4])
    assert not np.any(np.all(normals[:4] == given[:4], axis=1))
