"""Requests of the page: each edit is of one revision, and is answered with what is shown then."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from nodegraph.editor.file import EditedFile
from nodegraph.editor.page import page
from tests.nodegraph.editor.conftest import GRAPH, Editor


def test_a_view_has_text_picture_and_nodes(editor: Editor) -> None:
    view = editor.view()
    assert (view["text"], view["problems"], view["reason"]) == (GRAPH, [], "")
    assert view["nodes"] == {"capture": [6, 6], "gaps": [7, 7], "fill": [8, 10], "error": [11, 11]}
    assert view["svg"].count("data-box=") == 4
    assert (view["is_saved"], view["can_undo"], view["can_redo"]) == (True, False, False)


def test_the_page_has_the_text_as_text(path: Path) -> None:
    path.write_text("title: </div><script>bad()</script>\n")
    answer = page(EditedFile(path))
    assert "connect-src 'self'" in answer.headers["content-security-policy"]
    assert b"title: &lt;/div&gt;&lt;script&gt;bad()&lt;/script&gt;\n</div>" in bytes(answer.body)


def test_edits_undo_and_saving(editor: Editor, path: Path) -> None:
    view = editor.edit(text=GRAPH.replace("[5, 15]", "[5, 15, 45]"))
    assert "length: 5, 15, 45" in view["svg"]
    assert (view["is_saved"], view["can_undo"], path.read_text()) == (False, True, GRAPH)
    assert editor.edit(action="undo")["text"] == GRAPH
    assert editor.edit(action="redo")["text"] == view["text"]
    assert editor.edit(action="save")["is_saved"]
    assert path.read_text() == view["text"]


def test_an_edit_of_another_revision_changes_nothing(editor: Editor, path: Path) -> None:
    old = editor.view()["revision"]
    editor.edit(text="nodegraph: 1\n")
    for body in ({"text": "mine"}, {"action": "undo"}, {"action": "save"}):
        answer = editor.post(json.dumps({"revision": old, **body}).encode())
        assert (answer.status, answer.data["text"]) == (409, "nodegraph: 1\n")
    assert path.read_text() == GRAPH


@pytest.mark.parametrize(
    "body",
    [
        b"", b"{", b"7", b"[]", b"{}", b'{"revision": 1}', b'{"revision": 1, "action": "move"}',
        b'{"revision": 1, "action": ["save"]}', b'{"revision": [', b"[" * 5000, b"\xff",
    ],
)  # fmt: skip
def test_requests_that_are_not_understood_change_nothing(editor: Editor, body: bytes) -> None:
    answer = editor.post(body)
    assert (answer.status, list(answer.data)) == (400, ["message"])
    assert (editor.view()["text"], editor.view()["can_undo"]) == (GRAPH, False)


@pytest.mark.parametrize(
    ("text", "message", "there"),
    [
        ("nodes: [a\n", "this [ is not closed", "nodes: [".index("[")),
        ("just text", "a graph file is a mapping", 0),
        ("", "a graph file is a mapping", 0),
        (GRAPH.replace("fill.muscle", "fill.muscl"), "no node 'fill.muscl'", "fill.muscl"),
        (GRAPH.replace("gaps.gappy", "gaps.truth"), "gives the truth", "gaps.truth"),
        ("# \N{GRINNING FACE}\n" + GRAPH + "odd: 1\n", "unknown key 'odd'", "odd: 1"),
        (GRAPH.replace("# of three", "\N{LINE SEPARATOR}") + "odd: 1\n", "key 'odd'", "odd: 1"),
        ("x\0", "the character", 1),
        ("a: &a [*a]\n", "alias", None),
        ("[" * 3000, "nested", None),
    ],
)
def test_mistakes_have_their_place_and_the_text_stays(
    editor: Editor, text: str, message: str, there: object
) -> None:
    view = editor.edit(text=text)
    assert view["text"] == text
    found = next(each for each in view["problems"] if message in each["message"])
    assert found["is_error"]
    if isinstance(there, str):
        units = text.encode("utf-16-le")  # in which browsers count
        assert units[2 * found["at"] :].decode("utf-16-le").startswith(there)
    elif there is not None:
        assert found["at"] == there
    assert view["reason"]
    assert editor.edit(action="undo")["reason"] == ""


def test_mistakes_in_a_graph_that_is_used_name_that_file(editor: Editor, path: Path) -> None:
    inner = "nodegraph: 1\ninputs: {x: Trajectories}\nnodes: {f: {use: fill.odd, in: $x}}\n"
    (path.parent / "part.yaml").write_text(inner)
    view = editor.edit(text=GRAPH.replace("[fill.linear, fill.muscle]", "{p: {use: part.yaml}}"))
    places = {each["place"]: each["at"] for each in view["problems"]}
    assert places["part.yaml:3:18"] is None


def test_files_that_a_graph_reads_are_looked_at(editor: Editor, path: Path) -> None:
    assert editor.get("/files").data["problems"] == []
    (path.parent / "take.c3d").write_bytes(b"no recording")
    for name in ("take.c3d", "none.c3d"):
        view = editor.edit(text=GRAPH.replace("sample:face", name))
        found = [*view["problems"], *editor.get("/files").data["problems"]]
        assert [each["at"] for each in found if each["is_error"]] == [
            view["text"].index(f'"{name}')
        ]


def test_a_graph_too_large_to_draw_says_so(editor: Editor) -> None:
    nodes = [f"  n{number}: {{use: fill.linear, in: capture}}\n" for number in range(1000)]
    view = editor.edit(text=GRAPH.replace("report:", "".join(nodes) + "report:"))
    assert (view["problems"], view["svg"]) == ([], "")
    assert "1,004 nodes: more than 1,000 are not drawn here" in view["reason"]


def test_what_the_disk_has_meanwhile_is_not_overwritten(editor: Editor, path: Path) -> None:
    editor.edit(text=GRAPH.replace("Two", "Three"))
    other = GRAPH.replace("Two", "Four")
    path.write_text(other)
    refused = editor.edit(422, action="save")
    assert "has changed on the disk" in refused["refused"]
    assert (refused["theirs"], path.read_text()) == (other, other)
    assert editor.edit(action="keep_mine")["theirs"] is None
    editor.edit(action="save")
    assert "Three" in path.read_text()


def test_text_that_cannot_be_written_is_refused(editor: Editor) -> None:
    refused = editor.edit(422, text="\ud800")
    assert "not text in UTF-8" in refused["refused"]
    assert refused["text"] == GRAPH


def test_words_at_a_place_of_a_text_that_is_being_written(editor: Editor) -> None:
    text = "# \N{GRINNING FACE}\n" + GRAPH.replace("gaps.cut", "gaps.c")
    at = text.index("gaps.c") + len("gaps.c") + 1  # a browser counts the face twice
    answer = editor.post(json.dumps({"text": text, "at": at}).encode(), "/options").data
    assert answer["word"] == "gaps.c"
    assert "gaps.cut" in [option["word"] for option in answer["options"]]
    answer = editor.post(json.dumps({"text": GRAPH, "at": 3}).encode(), "/about").data
    assert answer["word"] == "nodegraph"
    assert (editor.view()["text"], editor.view()["can_undo"]) == (GRAPH, False)
    for at in (-1, 10**9, 0):
        for where in ("/options", "/about"):
            assert editor.post(json.dumps({"text": "", "at": at}).encode(), where).status == 200
    for odd in (b"", b"7", b"{}", b'{"text": "", "at": "x"}', b'{"text": "", "at": 1e999}'):
        assert editor.post(odd, "/options").status == 400
