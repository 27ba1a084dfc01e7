from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph_files.obj import read_obj

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def written(folder: Path, text: str, name: str = "neutral.obj") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "faces",
    ["f 1 2 3\nf 1 3 4", "f 1 2 3 4", "f 1/7 2/8 3/9 4/1", "f 1//1 2//1 3//1 4//1",
     "f -4 -3 -2 -1", "f 1/1/1 2/2/2 3/3/3 4/4/4 # a face", "f 1 2 \\\n3 4", "\tf  1 2 3 4 \r"],
)  # fmt: skip
def test_faces_are_triangles_however_they_are_written(tmp_path: Path, faces: str) -> None:
    head = read_obj(written(tmp_path, SQUARE + faces + "\n"))
    assert head.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert head.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert (head.unit, head.unit_stated, head.morphs) == ("mm", False, {})


def test_polygons_are_fans(tmp_path: Path) -> None:
    head = read_obj(written(tmp_path, SQUARE + "v 0 0.5 0\nf 1 2 3 4 5"))
    assert head.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 4]]


def test_what_is_no_mesh_is_passed_over(tmp_path: Path) -> None:
    other = "vt 0 0\nvn 0 0 1\ng skin\nusemtl a\ns 1\nl 1 2\n"
    text = f"# é\nmtllib a.mtl\no head\n{SQUARE}{other}f 1 2 3"
    path = tmp_path / "neutral.obj"
    path.write_bytes(text.encode("latin-1"))
    assert read_obj(path).faces.tolist() == [[0, 1, 2]]


def test_a_colour_or_weight_after_a_vertex_is_no_coordinate(tmp_path: Path) -> None:
    text = "v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1 2 3"
    assert read_obj(written(tmp_path, text)).vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def test_shapes_are_offsets_named_by_their_files(tmp_path: Path) -> None:
    neutral = written(tmp_path, SQUARE + "f 1 2 3 4")
    smile = written(tmp_path, SQUARE.replace("1 1 0", "1 3 0.5") + "f 1 2 3 4", "smile.obj")
    head = read_obj(neutral, (smile,))
    assert list(head.morphs) == ["smile"]
    np.testing.assert_array_equal(
        head.morphs["smile"], [[0, 0, 0], [0, 0, 0], [0, 2, 0.5], [0] * 3]
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 0 0 zero\nf 1 1 1", r":1:4: 'zero' is not a number"),
        ("v 0 0\nf 1 1 1", ":1: a vertex has three finite numbers"),
        ("v 0 0 nan\nf 1 1 1", ":1: a vertex has three finite numbers"),
        ("v 0 0 1e999\nf 1 1 1", ":1: a vertex has three finite numbers"),
        (SQUARE + "f 1 2 5", ":5: a face names vertex 5; there are 4"),
        ("f 1 2 5\n" + SQUARE, ":1: a face names vertex 5; there are 4"),
        (SQUARE + "f 1 2 -5", ":5: a face names vertex -5 of 4 so far"),
        (SQUARE + "f 1 2 0", ":5: '0' names no vertex"),
        (SQUARE + "f 1 2 x", ":5: 'x' names no vertex"),
        (SQUARE + f"f 1 2 {'9' * 50}", ":5: '9+' names no vertex"),
        (SQUARE + "f 1 2", ":5: a face has three corners at least"),
        (SQUARE, ": no mesh: it has 4 vertices and no faces"),
        ("glTF\0\1", ": no mesh: it has 0 vertices"),
    ],
)
def test_a_bad_file_is_refused_with_its_line(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"neutral\.obj{message}"):
        read_obj(written(tmp_path, text))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 9 9 9\n" + SQUARE + "f 1 2 3 4", r"smile\.obj: has 5 vertices, but neutral\.obj has 4"),
        (SQUARE + "f 4 1 2 3", r"smile\.obj: its faces are not those of neutral\.obj"),
        (SQUARE + "f 1 2 3", r"smile\.obj: its faces are not those of neutral\.obj"),
    ],
)
def test_a_shape_of_another_mesh_is_refused(tmp_path: Path, text: str, message: str) -> None:
    neutral = written(tmp_path, SQUARE + "f 1 2 3 4")
    with pytest.raises(ValueError, match=message):
        read_obj(neutral, (written(tmp_path, text, "smile.obj"),))
