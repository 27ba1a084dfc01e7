from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph_files.head import read_marker_vertices


def written(folder: Path, text: str) -> Path:
    path = folder / "marker_vertices.csv"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "text",
    ["marker,vertex\nnose,9\nchin,0\n", "\ufeffMarker, Vertex\r\n\r\nnose , 9\r\nchin,0",
     'marker,vertex\n"nose",9\n"chin","0"\n'],
)  # fmt: skip
def test_the_rows_are_read_in_their_order(tmp_path: Path, text: str) -> None:
    result = read_marker_vertices(written(tmp_path, text), 10)
    assert list(result.items()) == [("nose", 9), ("chin", 0)]


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("chin,10", "marker 'chin': no vertex 10; the mesh has 10, from 0"),
        (f"chin,{'9' * 30}", "marker 'chin': no vertex 9+"),
        ("nose,3", "marker 'nose' again"),
        ("chin,-1", "'-1' is not the number of a vertex"),
        ("chin,1.5", "'1.5' is not the number of a vertex"),
        ("chin,\u0663", "'\u0663' is not the number of a vertex"),
        ("chin,", "'' is not the number"),
        ("chin", "a marker and its vertex are needed, not 'chin'"),
        ("chin,1,2", "a marker and its vertex are needed, not 'chin,1,2'"),
        (",1", "a marker and its vertex are needed, not ',1'"),
        ('chin,"1', "unexpected end of data"),
    ],
)
def test_a_bad_row_is_refused_with_its_line(tmp_path: Path, row: str, message: str) -> None:
    path = written(tmp_path, f"marker,vertex\nnose,1\n{row}\n")
    with pytest.raises(ValueError, match=rf"marker_vertices\.csv:\d: .*{message}"):
        read_marker_vertices(path, 10)


@pytest.mark.parametrize("text", ["nose,1\nchin,2\n", "vertex,marker\n1,nose\n", "\n"])
def test_another_header_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(ValueError, match="csv:1: the header must be marker,vertex, not"):
        read_marker_vertices(written(tmp_path, text), 10)


def test_no_markers_are_no_error(tmp_path: Path) -> None:
    assert read_marker_vertices(written(tmp_path, "marker,vertex\n"), 10) == {}
