"""What the page does with one node: each edit changes its lines, or is refused with the reason."""

from __future__ import annotations

import random
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from nodegraph.editor.edits import Edits
from nodegraph.editor.file import EditedFile
from nodegraph.errors import GraphError
from nodegraph.plugin.registry import Registry
from tests.nodegraph.edit.graph_texts import Writer
from tests.nodegraph.editor.conftest import GRAPH, Editor


def act(editor: Editor, action: str, status: int = 200, **arguments: object) -> Any:
    return editor.edit(status, action=action, arguments=arguments)


def lines(view: Any) -> set[str]:
    """Return the lines that are not in the first text."""
    return set(view["text"].splitlines()) - set(GRAPH.splitlines())


@pytest.mark.parametrize(
    ("action", "arguments", "expected"),
    [
        (
            "set",
            {"path": ["nodes", "gaps", "with", "count"], "value": "3"},
            {"  gaps:    {use: gaps.cut, in: capture, with: {length: $length, count: 3}}"},
        ),
        (
            "set",
            {"path": ["nodes", "gaps", "with", "length"], "value": " "},
            {"  gaps:    {use: gaps.cut, in: capture}"},
        ),
        (
            "set",
            {"path": ["nodes", "fill", "alternatives", "muscle", "with", "max_gap"], "value": "9"},
            {
                "    alternatives: {linear: {use: fill.linear}, muscle: {use: fill.muscle, "
                "with: {max_gap: 9}}}"
            },
        ),
        (
            "connect",
            {"node": "error", "port": "estimate", "source": "gaps.gappy"},
            {
                "  error:   {use: score.gaps, in: {estimate: gaps.gappy, truth: gaps.truth, "
                "hidden: gaps.hidden}}"
            },
        ),
        (
            "disconnect",
            {"node": "error", "port": "truth"},
            {"  error:   {use: score.gaps, in: {estimate: fill, hidden: gaps.hidden}}"},
        ),
        (
            "disconnect",
            {"node": "gaps", "port": "recording"},
            {"  gaps:    {use: gaps.cut, with: {length: $length}}"},
        ),
        (
            "add_alternative",
            {"node": "fill", "use": "fill.pchip"},
            {"    alternatives: [fill.linear, fill.muscle, fill.pchip]"},
        ),
        (
            "add_alternative",
            {"node": "fill", "use": "fill.muscle"},
            {
                "    alternatives:",
                "      linear: {use: fill.linear}",
                "      muscle: {use: fill.muscle}",
                "      muscle_2: {use: fill.muscle}",
            },
        ),
        (
            "remove_alternative",
            {"node": "fill", "label": "muscle"},
            {"    alternatives: [fill.linear]"},
        ),
        (
            "add_node",
            {"name": "smooth", "use": "smooth.butterworth", "after": "gaps"},
            {"  smooth: {use: smooth.butterworth, in: gaps.gappy}"},
        ),
        (
            "add_node",
            {"name": "take", "use": "read.recording", "after": ""},
            {"  take: {use: read.recording}"},
        ),
        ("set_axis", {"name": "length", "labels": "{count: 3}"}, {"  length: {count: 3}"}),
        ("set_axis", {"name": "trial", "labels": "[a, b]"}, {"  trial: [a, b]"}),
        ("remove_node", {"name": "error"}, {"report: []"}),
        ("show", {"node": "fill"}, {"report: [error, fill]"}),
        ("hide", {"node": "error"}, {"report: []"}),
    ],
)
def test_an_action_changes_the_lines_that_it_names(
    editor: Editor, action: str, arguments: dict[str, Any], expected: set[str]
) -> None:
    view = act(editor, action, **arguments)
    assert lines(view) == expected
    assert "# of three" in view["text"]
    assert editor.edit(action="undo")["text"] == GRAPH


def test_a_name_changes_wherever_it_stands(editor: Editor) -> None:
    view = act(editor, "rename", old="gaps", new="cuts")
    assert "gaps." not in view["text"].replace("gaps.cut", "").replace("score.gaps", "")
    assert "cuts" in view["nodes"]
    assert view["problems"] == []


@pytest.mark.parametrize(
    ("action", "arguments", "reason"),
    [
        ("remove_node", {"name": "gaps"}, "'gaps' feeds fill, error"),
        ("remove_node", {"name": "none"}, "no 'none'"),
        ("rename", {"old": "gaps", "new": "fill"}, "'fill' is a name already"),
        ("rename", {"old": "gaps", "new": "a b"}, "cannot be a name"),
        ("add_node", {"name": "gaps", "use": "gaps.cut", "after": ""}, "is a name already"),
        ("remove_alternative", {"node": "gaps", "label": "x"}, "does not list 'x'"),
        ("set_axis", {"name": "gaps", "labels": "[1]"}, "is a name already"),
        ("set_axis", {"name": "k", "labels": "count: 3"}, "that would be a label"),
    ],
)
def test_what_cannot_be_done_is_refused_with_the_reason(
    editor: Editor, action: str, arguments: dict[str, str], reason: str
) -> None:
    view = act(editor, action, 422, **arguments)
    assert reason in view["refused"]
    assert (view["text"], view["can_undo"]) == (GRAPH, False)


@pytest.mark.parametrize(
    "arguments",
    [{}, {"name": 7}, {"name": "gaps", "more": "x"}, {"name": ["gaps"]}, [], "gaps", None],
)
def test_other_arguments_are_not_understood(editor: Editor, arguments: object) -> None:
    editor.edit(400, action="remove_node", arguments=arguments)
    paths: tuple[object, ...] = ("nodes", 7, {}, [], [[]], [None], None)
    for path in paths:
        editor.edit(400, action="set", arguments={"path": path, "value": "1"})
    assert editor.view()["text"] == GRAPH


def test_a_graph_begins_with_its_first_node(tmp_path: Path, registry: Registry) -> None:
    editor = Editor(tmp_path / "new.yaml", registry)
    assert editor.view()["reason"].startswith("the file is empty: ")
    act(editor, "add_node", name="take", use="read.recording", after="")
    act(editor, "set", path=["nodes", "take", "with", "path"], value="sample:face")
    act(editor, "add_node", name="gaps", use="gaps.cut", after="take")
    act(editor, "add_node", name="fill", use="fill.linear", after="gaps")
    act(editor, "add_alternative", node="fill", use="fill.muscle")
    act(editor, "set_axis", name="length", labels="[5, 15]")
    view = act(editor, "set", path=["nodes", "gaps", "with", "length"], value="$length")
    assert view["problems"] == []
    editor.edit(action="save")
    assert (
        (tmp_path / "new.yaml").read_text()
        == """\
nodegraph: 1
axes: {length: [5, 15]}
nodes:
  take: {use: read.recording, with: {path: "sample:face"}}
  gaps: {use: gaps.cut, in: take, with: {length: $length}}
  fill: {alternatives: {linear: {use: fill.linear}, muscle: {use: fill.muscle}}, in: gaps.gappy}
"""
    )


def test_a_panel_has_forms_and_what_fits(editor: Editor) -> None:
    panel = editor.get("/node?name=fill").data
    *own, shared = panel["sections"]
    assert [each["title"] for each in own] == ["linear", "muscle"]
    settings = {each["name"]: each for each in shared["settings"]}
    assert settings["ends"]["words"] == ["as_published", "met"]
    assert (settings["ends"]["is_closed"], settings["max_gap"]["is_closed"]) == (True, False)
    assert settings["ends"]["variables"] == ["$length"]
    assert "in frames" in settings["max_gap"]["about"]
    (port,) = panel["ports"]
    assert (port["name"], port["feed"]) == ("recording", "gaps.gappy")
    reasons = {each["source"]: each["reason"] for each in port["sources"]}
    assert reasons["capture"] == reasons["gaps.gappy"] == ""
    assert "gives the truth" in reasons["gaps.truth"]
    assert reasons["gaps.hidden"] == "'recording' takes Trajectories, not Mask"
    assert reasons["error"] == "error reads fill"
    rivals = {each["use"]: each["reason"] for each in panel["rivals"]}
    assert rivals["fill.pchip"] == ""
    used = {each["use"] for each in panel["rivals"] if each["is_used"]}
    assert used == {"fill.linear", "fill.muscle"}
    assert panel["alternatives"] == ["linear", "muscle"]
    assert not panel["is_shown"]
    error = editor.get("/node?name=error").data
    assert error["is_shown"]
    reasons = {each["use"]: each["reason"] for each in error["rivals"]}
    assert reasons["score.alignment"] == "it has no port estimate"
    ports = error["ports"]
    assert [each["feed"] for each in ports[:2]] == ["fill", "gaps.truth"]


def test_an_output_has_the_ports_that_it_fits(editor: Editor) -> None:
    found = editor.get("/targets?box=gaps&port=hidden").data
    assert found["source"] == "gaps.hidden"
    assert found["ports"]["error"] == {
        "estimate": "'estimate' takes Trajectories, not Mask",
        "truth": "'truth' takes Trajectories, not Mask",
        "hidden": "",
    }
    assert set(found["ports"]["gaps"].values()) == {"a node cannot feed itself"}
    found = editor.get("/targets?box=fill&port=output").data
    assert (found["source"], found["ports"]["error"]["truth"]) == ("fill", "")
    assert found["ports"]["gaps"]["recording"] == "fill reads gaps"
    leak = editor.get("/targets?box=gaps&port=truth").data["ports"]["fill"]["recording"]
    assert "must not see it" in leak
    assert editor.get("/targets?box=odd&port=x").status == 409
    nodes = {each["use"] for each in editor.get("/nodes?source=error").data}
    assert "compare.table" in nodes
    assert "fill.linear" not in nodes
    view = act(editor, "add_node", name="more", use="score.gaps", after="gaps.hidden")
    wiring = "{hidden: gaps.hidden, truth: gaps.truth}"  # several outputs fit the estimate
    assert lines(view) == {f"  more: {{use: score.gaps, in: {wiring}}}"}


PART = """\
nodegraph: 1
inputs: {x: Trajectories, ends: met}
nodes:
  cut: {use: gaps.cut, in: $x}
  fill: {use: fill.linear, in: cut.gappy, with: {ends: $ends}}
outputs: {filled: fill, hidden: cut.hidden}
"""


def test_a_graph_that_is_used_has_ports_whatever_is_wrong(editor: Editor, path: Path) -> None:
    (path.parent / "part.yaml").write_text(PART)
    text = GRAPH.replace("report:", "  part: {use: part.yaml}\nreport:")
    view = editor.edit(text=text)
    assert [each["message"] for each in view["problems"]] == [
        "part: port x: Trajectories of part.yaml is not fed"
    ]
    assert 'data-input="x"' in view["svg"]
    panel = editor.get("/node?name=part").data
    (port,), ((setting,),) = panel["ports"], [each["settings"] for each in panel["sections"]]
    assert (port["name"], port["type"], port["feed"]) == ("x", "Truth[Trajectories]", "")
    assert (setting["name"], setting["about"]) == ("ends", "Default: met.")
    view = act(editor, "connect", node="part", port="x", source="capture")
    assert "part: {use: part.yaml, in: {x: capture}}" in view["text"]
    assert view["problems"] == []
    for box, source in (("part", "part.filled"), ("part.hidden", "part.hidden")):
        port = box.rpartition(".")[2].replace("part", "filled")
        found = editor.get(f"/targets?box={box}&port={port}").data
        assert (found["source"], found["ports"]["part"]["x"]) == (
            source, "a node cannot feed itself",
        )  # fmt: skip
    refused = editor.get("/targets?box=part.cut&port=truth")
    assert refused.status == 409
    assert "outside it are filled, hidden" in refused.data["message"]


def test_a_whole_family_has_one_of_its_methods_once_more(editor: Editor) -> None:
    family = "{without: {use: pass}, fill.*: {}}"
    editor.edit(text=GRAPH.replace("[fill.linear, fill.muscle]", family))
    panel = editor.get("/node?name=fill").data
    assert all(each["is_used"] for each in panel["rivals"])
    first, *_, shared = panel["sections"]
    assert (first["title"], first["is_known"]) == ("without", True)
    said = {each["name"]: each["about"] for each in shared["settings"]}
    assert said["ends"].startswith("as_published: the estimate as it is")
    view = act(editor, "add_alternative", node="fill", use="fill.ridge")
    assert "fill.*: {}, ridge_2: {use: fill.ridge}}" in view["text"]
    assert view["problems"] == []


def test_a_panel_of_a_graph_with_mistakes(editor: Editor) -> None:
    view = editor.edit(text=GRAPH.replace("in: capture", "in: none"))
    assert view["svg"].count("data-box=") == 4
    assert (view["wrong"], len(view["problems"])) == (["gaps"], 1)
    assert "drawn as far" in view["reason"]
    port = editor.get("/node?name=gaps").data["ports"][0]
    assert (port["name"], port["feed"]) == ("recording", "none")
    view = act(editor, "connect", node="gaps", port="recording", source="capture")
    assert (view["text"], view["problems"]) == (GRAPH, [])
    circle = editor.edit(text=GRAPH.replace("in: capture", "in: fill"))
    assert circle["svg"] == ""
    assert "picture is that of before" in circle["reason"]
    editor.edit(text="nodes: [a\n")
    assert editor.get("/node?name=gaps").status == 409
    assert editor.get("/axes").status == 409


def test_axes_and_nodes_that_can_be_added(editor: Editor) -> None:
    assert editor.get("/axes").data == [{"name": "length", "labels": "[5, 15]"}]
    nodes = {each["use"]: each["about"] for each in editor.get("/nodes").data}
    assert "fill.muscle" in nodes
    assert "Out: gappy: Trajectories" in " ".join(nodes["gaps.cut"])


def test_nodes_move_into_a_graph_beside_this(editor: Editor, path: Path) -> None:
    view = act(
        editor, "move_to_graph", nodes=["gaps", "fill"], name="part", into="parts/filled.yaml"
    )
    assert view["problems"] == []
    assert list(view["nodes"]) == ["capture", "part", "error"]
    assert 'data-frame="part"' in view["svg"]
    part = editor.get("/node?name=part").data
    assert [each["is_known"] for each in part["sections"]] == [True]
    inner = path.parent / "parts" / "filled.yaml"
    assert "alternatives: [fill.linear, fill.muscle]" in inner.read_text()
    assert path.read_text() == GRAPH
    before = sorted(path.parent.parent.rglob("*"))
    for into, reason in (
        ("../part.yaml", "is outside the folder"),
        ("/tmp/part.yaml", "is outside the folder"),
        ("parts/filled.yaml", "is there already"),
        ("part.txt", "no name of a graph file"),
        ("", "is there already"),
    ):
        view = act(editor, "move_to_graph", 422, nodes=["error"], name="last", into=into)
        assert reason in view["refused"]
    assert sorted(path.parent.parent.rglob("*")) == before
    assert editor.edit(action="undo")["text"] == GRAPH


@pytest.mark.parametrize("seed", range(12))
def test_any_edits_undone_give_the_first_bytes(
    tmp_path: Path, registry: Registry, seed: int
) -> None:
    path = tmp_path / "graph.yaml"
    assert edited_and_undone(path, registry, seed, edits=40) > 10
    assert path.read_bytes() == Writer(seed).text.encode()
    assert [each.name for each in tmp_path.iterdir()] == ["graph.yaml"]


def edited_and_undone(path: Path, registry: Registry, seed: int, *, edits: int) -> int:
    """Edit a graph at random, undo it all, and return the number of edits.

    The first text, which comes back, is that of `Writer`.
    """
    writer, draw = Writer(seed), random.Random(seed)
    path.write_bytes(writer.text.encode())
    file = EditedFile(path)
    actions = Edits(registry, path)
    nodes = ("capture", "gaps", *writer.fills)
    done = 0
    for number in range(edits):
        name, arguments = draw.choice(
            (
                ("rename", {"old": draw.choice(nodes), "new": f"name_{number}"}),
                ("remove_node", {"name": draw.choice(nodes)}),
                ("set_axis", {"name": draw.choice(("length", "new")), "labels": "[1, 2]"}),
                ("add_alternative", {"node": "fill", "use": "fill.pchip"}),
                ("disconnect", {"node": draw.choice(nodes), "port": "recording"}),
                ("connect", {"node": "fill", "port": "recording", "source": "capture"}),
                ("set", {"path": ["nodes", "gaps", "with", "seed"], "value": str(number)}),
                ("add_node", {"name": f"n{number}", "use": "fill.linear", "after": "gaps"}),
            )
        )
        with suppress(GraphError):  # of what is not there any more, or cannot be written there
            file.put(actions.named(name, arguments)(file.text))
            done += 1
        if draw.random() < 0.2:
            draw.choice((file.undo, file.redo))()
        if draw.random() < 0.2:
            file.edit(f"# {number}\n{file.shown}")
    while file.can_undo:
        file.undo()
    assert file.text.encode() == writer.text.encode()
    return done
