from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nodegraph_files.glb.buffers import Accessors, GlbBuffer
from nodegraph_files.glb.document import Document, Primitive
from nodegraph_files.glb.reading import Placed, placed_meshes, vertex_matrices

MESH: dict[str, object] = {"primitives": [{"attributes": {}}]}


def placed(nodes: list[dict[str, object]], **parts: object) -> list[Placed]:
    document = {"asset": {"version": "2.0"}, "nodes": nodes, "meshes": [MESH, MESH], **parts}
    return placed_of(Document.model_validate(document), b"")


def placed_of(document: Document, binary: bytes) -> list[Placed]:
    return placed_meshes(document, Accessors(document, binary))


def test_a_mesh_is_turned_scaled_and_shifted_in_this_order() -> None:
    turn = Rotation.from_euler("xyz", [0.3, -0.8, 1.2])
    node = {"mesh": 0, "translation": [1, 2, 3], "scale": [2, 3, 0.5],
            "rotation": (turn.as_quat() * 2).tolist()}  # fmt: skip
    point = np.array([0.4, -0.5, 0.6])
    expected = turn.apply(point * [2, 3, 0.5]) + np.array([1, 2, 3])
    (mesh,) = placed([node])
    np.testing.assert_allclose((mesh.matrices @ [*point, 1])[:3], expected, rtol=1e-12)


def test_a_matrix_is_stored_by_columns_and_parents_come_last() -> None:
    matrix = np.eye(4)
    matrix[:3, 3] = [1, 2, 3]
    nodes: list[dict[str, object]] = [
        {"children": [1], "scale": [2, 2, 2]},
        {"mesh": 0, "matrix": matrix.T.ravel().tolist()},
    ]
    (mesh,) = placed(nodes)
    np.testing.assert_array_equal(mesh.matrices @ [1, 1, 1, 1], [4, 6, 8, 1])


def test_the_scene_says_what_is_shown_and_in_what_order() -> None:
    nodes: list[dict[str, object]] = [{"mesh": 0}, {"mesh": 1, "children": [0]}, {"mesh": 0}]
    assert [mesh.node for mesh in placed(nodes, scenes=[{"nodes": [2, 1]}])] == [2, 1, 0]
    scenes = [{"nodes": [2]}, {"nodes": [1]}]
    assert [mesh.node for mesh in placed(nodes, scenes=scenes, scene=1)] == [1, 0]
    assert [mesh.node for mesh in placed(nodes)] == [1, 0, 2]


def test_a_file_without_nodes_shows_every_mesh() -> None:
    assert [mesh.mesh for mesh in placed([])] == [0, 1]


@pytest.mark.parametrize(
    ("nodes", "parts", "message"),
    [
        ([{"children": [0]}], {"scenes": [{"nodes": [0]}]}, "node 0 is in the scene twice"),
        ([{"children": [7]}], {}, "there is no node 7; the file has 1"),
        ([{}], {"scenes": [{}], "scene": 2}, "there is no scene 2"),
        ([{"mesh": 0, "rotation": [0, 0, 0, 0]}], {}, "node 0: its rotation is zero"),
        ([{"mesh": 0, "skin": 0}], {}, "node 0: there is no skin 0"),
        ([{"mesh": 0, "skin": 0}], {"skins": [{"joints": [3]}]}, "skin 0: its joint, node 3, is n"),
    ],
)
def test_what_is_no_tree_is_refused(
    nodes: list[dict[str, object]], parts: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        placed(nodes, **parts)


def test_a_deep_tree_is_read() -> None:
    nodes: list[dict[str, object]] = [{"children": [n + 1]} for n in range(5000)]
    assert [mesh.node for mesh in placed([*nodes, {"mesh": 0}])] == [5000]


def skinned(joints: list[list[int]], pulls: list[list[float]]) -> tuple[Placed, Any]:
    """Return a mesh of a node that is moved, held by two joints, of which one has moved by 5."""
    buffer = GlbBuffer()
    bind = np.tile(np.eye(4), (2, 1, 1))
    bind[1, :3, 3] = [0, -1, 0]
    held = buffer.keys(np.array(pulls), "weights")
    rows = buffer.keys(bind.transpose(0, 2, 1).reshape(-1, 4), "bind")
    buffer.accessors[rows] |= {"type": "MAT4", "count": 2}
    numbers = np.array(joints, "<u1").tobytes()
    view = {"buffer": 0, "byteOffset": len(buffer.content), "byteLength": len(numbers)}
    count = len(pulls)
    document = Document.model_validate({
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0, "skin": 0, "translation": [90, 90, 90]}, {},
                  {"translation": [5, 1, 0]}],
        "meshes": [MESH],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": rows}],
        "accessors": [*buffer.accessors, {"bufferView": len(buffer.views), "type": "VEC4",
                                          "componentType": 5121, "count": count}],
        "bufferViews": [*buffer.views, view],
        "buffers": [{"byteLength": 1}],
    })  # fmt: skip
    binary = buffer.content + numbers
    primitive = Primitive(attributes={"JOINTS_0": len(buffer.accessors), "WEIGHTS_0": held})
    accessors = Accessors(document, binary)
    (mesh,) = placed_meshes(document, accessors)
    return mesh, lambda: vertex_matrices(mesh, primitive, accessors, "mesh 0", count)


def test_joints_alone_hold_a_skinned_mesh() -> None:
    _, matrices = skinned([[0, 1, 0, 0]] * 3, [[1, 0, 0, 0], [0, 2, 0, 0], [0.5, 0.5, 0, 0]])
    moved = matrices() @ [1.0, 1.0, 1.0, 1.0]
    np.testing.assert_allclose(moved[:, :3], [[1.0, 1.0, 1.0], [6.0, 1.0, 1.0], [3.5, 1.0, 1.0]])


def test_a_skin_that_does_not_hold_is_refused() -> None:
    _, loose = skinned([[0, 1, 0, 0]] * 2, [[1, 0, 0, 0], [0, 0, 0, 0]])
    with pytest.raises(ValueError, match="mesh 0: the skin does not hold vertex 1"):
        loose()
    _, absent = skinned([[0, 2, 0, 0]], [[1, 0, 0, 0]])
    with pytest.raises(ValueError, match=r"mesh 0\.JOINTS_0: names joint 2 of 2"):
        absent()
