from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph.testing import same
from nodegraph_files import head_bytes
from nodegraph_files.readers import read_head, read_model
from nodegraph_mocap.specimens import heads
from tests.studies import DATA, needs_recordings

HERE = Path(__file__).parent
FACECAP = DATA / "facecap"
HEAD = heads()["complete"]
TABLE = "marker,vertex\nnose,3\nchin,0\n"
OBJ = (HERE / "head.obj").read_text()


@pytest.mark.parametrize("name", ["head.glb", "any.GLB", "head"])
def test_a_glb_file_is_read_in_millimetres(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(head_bytes(HEAD))
    head = read_head(path=path)
    np.testing.assert_allclose(head.vertices, HEAD.vertices, rtol=1e-7)
    assert (head.names, head.markers) == (HEAD.names, HEAD.markers)


def test_an_obj_file_is_taken_for_millimetres(tmp_path: Path) -> None:
    path = tmp_path / "Any.OBJ"
    path.write_text(OBJ)
    with pytest.warns(UserWarning, match=r"Any\.OBJ: OBJ states no unit of length; mm is taken"):
        head = read_head(path=path)
    assert head.vertices[4].tolist() == [0, 120, 0]
    assert (head.morphs.shape, head.markers) == ((0, 5, 3), ())


def test_a_unit_can_be_said(tmp_path: Path) -> None:
    path = tmp_path / "head.obj"
    path.write_text("v 0 0 0\nv 10 0 0\nv 0 9 0\nf 1 2 3")
    assert read_head(path=path, unit="in").vertices[1].tolist() == [254, 0, 0]
    with pytest.warns(UserWarning, match="the mesh is 10 mm long in mm, which no head is"):
        assert read_head(path=path, unit="mm").vertices[1].tolist() == [10, 0, 0]


def test_a_folder_of_obj_files_is_a_head_with_morph_targets(tmp_path: Path) -> None:
    (tmp_path / "neutral.obj").write_text(OBJ)
    (tmp_path / "smile.obj").write_text(OBJ.replace("v 0 20 95", "v 0 25 95"))
    (tmp_path / "jawOpen.obj").write_text(OBJ.replace("v 0 -110 60", "v 0 -130 60"))
    (tmp_path / "notes.txt").write_text("not read")
    (tmp_path / "marker_vertices.csv").write_text(TABLE)
    head = read_head(path=tmp_path, unit="mm")
    assert head.names == ("jawOpen", "smile")
    assert head.morphs[:, [0, 3], 1].tolist() == [[-20, 0], [0, 5]]
    assert (head.markers, head.marker_vertices.tolist()) == (("nose", "chin"), [3, 0])


def test_what_lies_beside_a_file_counts_only_if_its_folder_is_named(tmp_path: Path) -> None:
    path = tmp_path / "head.glb"
    path.write_bytes(head_bytes(HEAD))
    table = tmp_path / "marker_vertices.csv"
    table.write_text(TABLE)
    assert read_head(path=path).markers == HEAD.markers
    assert read_head(path=tmp_path).markers == ("nose", "chin")
    assert same(read_head(path=path, marker_vertices=table), read_head(path=tmp_path))
    assert same(read_head(path=path, marker_vertices=tmp_path), read_head(path=tmp_path))


@pytest.mark.parametrize("name", ["head.fbx", "head.gltf", "head"])
def test_another_form_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text("{}")
    with pytest.raises(ValueError, match=rf"{name}: .*GLB.*OBJ"):
        read_head(path=path)


def test_a_folder_without_head_says_what_is_there(tmp_path: Path) -> None:
    (tmp_path / "smile.obj").write_text(OBJ)
    with pytest.raises(ValueError, match=r"no head\.glb or neutral\.obj or head\.obj; there is sm"):
        read_head(path=tmp_path)


@needs_recordings
def test_a_real_head_is_its_own_model() -> None:
    model = read_model(path=FACECAP / "model_60_markers.npz").model
    table = FACECAP / "marker_vertices.csv"
    with pytest.warns(UserWarning, match="would be 235.7 m long; mm is taken, giving 235.7 mm"):
        head = read_head(path=FACECAP / "head.glb", marker_vertices=table)
    assert (head.names, head.markers) == (model.names, model.markers)
    np.testing.assert_array_equal(head.vertices[head.marker_vertices], model.neutral)
    # the file's morph targets went through half precision
    stored = model.shapes.astype(np.float16)
    np.testing.assert_array_equal(head.morphs[:, head.marker_vertices], stored)
