from __future__ import annotations

import numpy as np
import pytest

from nodegraph_files.glb.buffers import Accessors, GlbBuffer
from nodegraph_files.glb.document import Document
from nodegraph_files.glb.reading import Placed, joined_parts, read_mesh
from nodegraph_files.head import RawHead

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FACES = np.array([[0, 1, 2], [0, 2, 3]])
HERE = Placed(0, 0, np.eye(4))


class MeshFile:
    """A mesh in the making: arrays in a buffer, primitives that name them."""

    def __init__(self) -> None:
        self.buffer = GlbBuffer()
        self.positions = self.buffer.vertices(SQUARE, "vertices")
        self.faces = self.buffer.corners(FACES)

    def primitive(self, **changes: object) -> dict[str, object]:
        given = {"attributes": {"POSITION": self.positions}, "indices": self.faces}
        return {key: value for key, value in (given | changes).items() if value is not None}

    def target(self, offsets: object) -> dict[str, int]:
        return {"POSITION": self.buffer.vertices(np.asarray(offsets, float), "target")}

    def document(
        self, *primitives: dict[str, object], **mesh: object
    ) -> tuple[Document, Accessors]:
        parts = {
            "asset": {"version": "2.0"},
            "meshes": [{"primitives": primitives or [self.primitive()], **mesh}],
            "accessors": self.buffer.accessors,
            "bufferViews": self.buffer.views,
            "buffers": [{"byteLength": len(self.buffer.content)}],
        }
        document = Document.model_validate(parts)
        return document, Accessors(document, self.buffer.content)

    def read(
        self, *primitives: dict[str, object], placed: Placed = HERE, **mesh: object
    ) -> RawHead:
        document, accessors = self.document(*primitives, **mesh)
        return read_mesh(document.meshes[0], placed, accessors)


@pytest.fixture
def mesh_file() -> MeshFile:
    return MeshFile()


def test_a_plain_mesh_is_read(mesh_file: MeshFile) -> None:
    part = mesh_file.read()
    np.testing.assert_array_equal(part.vertices, SQUARE)
    np.testing.assert_array_equal(part.faces, FACES)
    assert part.morphs == {}


def test_morph_targets_have_the_names_of_the_extras(mesh_file: MeshFile) -> None:
    offsets = np.arange(12.0).reshape(4, 3)
    primitive = mesh_file.primitive(targets=[mesh_file.target(offsets), {"NORMAL": 99}])
    part = mesh_file.read(primitive, extras={"targetNames": ["smile", "still"]})
    assert list(part.morphs) == ["smile", "still"]
    np.testing.assert_array_equal(part.morphs["smile"], offsets)
    assert not part.morphs["still"].any()


@pytest.mark.parametrize("extras", [None, {}, [1]])
def test_morph_targets_without_names_are_numbered(mesh_file: MeshFile, extras: object) -> None:
    primitive = mesh_file.primitive(targets=[mesh_file.target(SQUARE)] * 2)
    with pytest.warns(UserWarning, match=r"mesh 0 \(face\): its 2 morph targets have no names"):
        part = mesh_file.read(primitive, name="face", extras=extras)
    assert list(part.morphs) == ["morph_1", "morph_2"]


def test_primitives_of_the_same_vertices_share_them(mesh_file: MeshFile) -> None:
    second = mesh_file.buffer.corners(FACES[1:])
    part = mesh_file.read(mesh_file.primitive(), mesh_file.primitive(indices=second, material=3))
    assert len(part.vertices) == 4
    assert part.faces.tolist() == [*FACES.tolist(), [0, 2, 3]]


def test_primitives_of_other_vertices_follow(mesh_file: MeshFile) -> None:
    other = {"POSITION": mesh_file.buffer.vertices(SQUARE + 5, "vertices")}
    part = mesh_file.read(mesh_file.primitive(), mesh_file.primitive(attributes=other))
    np.testing.assert_array_equal(part.vertices, [*SQUARE, *(SQUARE + 5)])
    assert part.faces.tolist() == [*FACES.tolist(), *(FACES + 4).tolist()]


@pytest.mark.parametrize(
    ("mode", "order", "faces"),
    [
        (4, None, [[0, 1, 2]]),
        (5, [0, 1, 2, 3], [[0, 1, 2], [1, 3, 2]]),
        (6, [0, 1, 2, 3], [[1, 2, 0], [2, 3, 0]]),
    ],
)
def test_strips_and_fans_become_triangles(
    mesh_file: MeshFile, mode: int, order: list[int] | None, faces: list[list[int]]
) -> None:
    indices = None if order is None else mesh_file.buffer.corners(np.array([order]))
    rest = (
        {"POSITION": mesh_file.buffer.vertices(SQUARE[:3], "vertices")} if order is None else None
    )
    changes = {"attributes": rest} if rest else {}
    assert (
        mesh_file.read(mesh_file.primitive(mode=mode, indices=indices, **changes)).faces.tolist()
        == faces
    )


def test_points_and_lines_are_left_out_and_reported(mesh_file: MeshFile) -> None:
    with pytest.warns(UserWarning, match="mesh 0, primitive 1: points or lines, which are left"):
        part = mesh_file.read(mesh_file.primitive(), mesh_file.primitive(mode=1))
    assert len(part.faces) == 2


def test_a_mesh_stands_where_its_node_is(mesh_file: MeshFile) -> None:
    offsets = np.ones((4, 3))
    matrix = np.diag([2.0, -3.0, 1.0, 1.0])
    matrix[:3, 3] = [10, 20, 30]
    part = mesh_file.read(
        mesh_file.primitive(targets=[mesh_file.target(offsets)]),
        placed=Placed(0, 0, matrix),
        extras={"targetNames": ["smile"]},
    )
    np.testing.assert_array_equal(part.vertices, SQUARE * [2, -3, 1] + np.array([10, 20, 30]))
    np.testing.assert_array_equal(part.morphs["smile"], offsets * [2, -3, 1])
    # a mirror image shows its inside, were it not turned round
    assert part.faces.tolist() == FACES[:, ::-1].tolist()


def test_a_part_without_a_morph_target_stays_where_it_is() -> None:
    part = RawHead(SQUARE, FACES, {"smile": SQUARE}, "m", marker_vertices={"nose": 3})
    morphs = {"frown": SQUARE * 2, "smile": SQUARE * 3}
    other = RawHead(SQUARE + 1, FACES, morphs, "m", marker_vertices={"chin": 0})
    joined = joined_parts([part, other])
    assert list(joined.morphs) == ["smile", "frown"]
    np.testing.assert_array_equal(joined.morphs["smile"], [*SQUARE, *(SQUARE * 3)])
    np.testing.assert_array_equal(joined.morphs["frown"], [*np.zeros((4, 3)), *(SQUARE * 2)])
    assert joined.marker_vertices == {"nose": 3, "chin": 4}


def test_markers_come_from_the_extras(mesh_file: MeshFile) -> None:
    part = mesh_file.read(extras={"markerVertices": {"nose": 3, "chin": 3}})
    assert list(part.marker_vertices.items()) == [("nose", 3), ("chin", 3)]


@pytest.mark.parametrize("given", [5, ["nose"], {"nose": 4}, {"nose": -1}, {"nose": True},
                                   {"nose": 1.0}])  # fmt: skip
def test_markers_of_no_vertex_are_refused(mesh_file: MeshFile, given: object) -> None:
    with pytest.raises(ValueError, match="markerVertices must give each marker one of 4 vert"):
        mesh_file.read(extras={"markerVertices": given})


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["smile"], "mesh 0: 1 names for 2 morph targets"),
        (["smile", "smile"], "mesh 0, morph targets: named twice: smile"),
        (["smile", 5], "mesh 0: extras.targetNames must be a list of names"),
        ("ab", "mesh 0: extras.targetNames must be a list of names"),
    ],
)
def test_names_that_do_not_fit_are_refused(
    mesh_file: MeshFile, names: object, message: str
) -> None:
    primitive = mesh_file.primitive(targets=[mesh_file.target(SQUARE)] * 2)
    with pytest.raises(ValueError, match=message):
        mesh_file.read(primitive, extras={"targetNames": names})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"attributes": {"NORMAL": 0}}, "mesh 0, primitive 0: its vertices have no POSITION"),
        ({"attributes": {"POSITION": 9}}, "there is no accessor 9"),
        ({"attributes": {"POSITION": 1}}, "accessor 1: must be VEC3, not SCALAR"),
        ({"indices": 0}, "accessor 0: must be SCALAR, not VEC3"),
        ({"indices": None}, "4 corners make no triangles"),
    ],
)
def test_a_bad_primitive_is_refused(
    mesh_file: MeshFile, changes: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        mesh_file.read(mesh_file.primitive(**changes))


def test_a_face_beyond_the_vertices_is_refused(mesh_file: MeshFile) -> None:
    faces = mesh_file.buffer.corners(np.array([[0, 1, 4]]))
    with pytest.raises(ValueError, match="mesh 0, primitive 0: a face names vertex 4 of 4"):
        mesh_file.read(mesh_file.primitive(indices=faces))


def test_a_morph_target_of_another_length_is_refused(mesh_file: MeshFile) -> None:
    primitive = mesh_file.primitive(targets=[mesh_file.target(SQUARE[:3])])
    message = "mesh 0, primitive 0, morph target 'smile': accessor 2: has 3 values where 4 are need"
    with pytest.raises(ValueError, match=message):
        mesh_file.read(primitive, extras={"targetNames": ["smile"]})


def test_primitives_of_unlike_morph_targets_are_refused(mesh_file: MeshFile) -> None:
    primitives = [mesh_file.primitive(targets=[mesh_file.target(SQUARE)]), mesh_file.primitive()]
    with pytest.raises(ValueError, match="primitive 1: 0 morph targets where the mesh has 1"):
        mesh_file.read(*primitives, extras={"targetNames": ["smile"]})
