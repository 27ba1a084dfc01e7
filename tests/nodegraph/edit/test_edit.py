"""Edits of graph files: what they change, and what they leave."""

from __future__ import annotations

import copy
import difflib
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import yaml

from nodegraph import edit
from nodegraph.errors import GraphError
from nodegraph.graph import build
from nodegraph.graphfile.reader import read_graph_text
from nodegraph.graphfile.yaml_text import read_yaml
from nodegraph.plugin.registry import Registry
from tests.environments import ROOT
from tests.nodegraph.edit.graph_texts import Writer

GRAPHS = sorted(ROOT.glob("graphs/**/*.yaml"))
SEEDS = range(20)
FILL = "nodegraph: 1\nnodes:\n  a: {use: read.recording}\n  fill: {use: fill.muscle, in: a}\n"


@pytest.fixture(scope="module")
def registry() -> Registry:
    return Registry.installed()


def text_of(path: Path) -> str:
    with path.open(encoding="utf-8", newline="") as file:
        return file.read()


def data_of(text: str) -> Any:
    return yaml.load(text, yaml.CSafeLoader)


def changed(before: str, after: str) -> tuple[list[str], list[str]]:
    """Return the lines that went, and those that came."""
    lines = list(difflib.ndiff(before.splitlines(keepends=True), after.splitlines(keepends=True)))
    went = [line[2:] for line in lines if line.startswith("- ")]
    return went, [line[2:] for line in lines if line.startswith("+ ")]


def comments(text: str) -> Counter[str]:
    return Counter(line.strip() for line in text.splitlines() if line.strip().startswith("#"))


@pytest.mark.parametrize("path", GRAPHS, ids=lambda path: path.stem)
def test_a_name_of_a_shipped_graph_changes_everywhere_and_back(
    path: Path, registry: Registry
) -> None:
    text = text_of(path)
    data = data_of(text)
    for name in [*data.get("axes", {}), *data["nodes"]]:
        renamed = edit.rename(text, name, "renamed_name", registry=registry)
        assert edit.rename(renamed, "renamed_name", name, registry=registry) == text
        went, came = changed(text, renamed)
        assert len(went) == len(came)
        assert comments(renamed) == comments(text)


@pytest.mark.parametrize("name", ["fill", "length", "condition", "gaps", "recording"])
def test_a_renamed_study_is_the_same_study(name: str, registry: Registry) -> None:
    path = ROOT / "graphs" / "fill.yaml"
    text = text_of(path)
    graphs = [
        build(read_graph_text(each, path.name, path.parent), registry)
        for each in (text, edit.rename(text, name, "other", registry=registry))
    ]
    before, after = ({node.name: node.axes for node in graph.nodes.values()} for graph in graphs)
    swap = {name: "other"}
    assert after == {
        swap.get(node, node): tuple(swap.get(axis, axis) for axis in axes)
        for node, axes in before.items()
    }


@pytest.mark.parametrize("seed", SEEDS)
def test_an_edit_changes_the_lines_that_it_names_and_can_be_taken_back(
    seed: int, registry: Registry
) -> None:
    writer = Writer(seed)
    text, name = writer.text, writer.fills[-1]
    data = data_of(text)

    # a setting that is new, with and without others beside it
    before = data["nodes"][name].get("with")
    with_setting = edit.set_value(text, ("nodes", name, "with", "new"), [1, "ü: #"])
    expected = copy.deepcopy(data)
    expected["nodes"][name]["with"] = {**(before or {}), "new": [1, "ü: #"]}
    assert data_of(with_setting) == expected
    went, came = changed(text, with_setting)
    assert (len(went), len(came)) in {(0, 1), (1, 1), (1, 2)}
    assert comments(with_setting) == comments(text)
    if before:
        assert edit.unset(with_setting, ("nodes", name, "with", "new")) == text

    # a number, and back
    length = ("nodes", "gaps", "with", "length")
    shorter = edit.set_value(text, length, 7)
    assert edit.set_value(shorter, length, "$length") == text
    assert [len(lines) for lines in changed(text, shorter)] == [1, 1]

    # a node, and away with it
    added = edit.add_node(text, "mine", {"use": "fill.mine", "in": "gaps"}, after=name)
    assert list(data_of(added)["nodes"]).index("mine") == list(data["nodes"]).index(name) + 1
    assert edit.remove_node(added, "mine", registry=registry) == text
    assert [len(lines) for lines in changed(text, added)] == [0, 1]

    # an alternative: the node becomes an axis, and its settings those of the first
    rival = edit.add_alternative(text, name, "mine", {"use": "fill.mine"})
    methods = data_of(rival)["nodes"][name]["alternatives"]
    assert methods == {
        "muscle": {"use": "fill.muscle", **({"with": before} if before else {})},
        "mine": {"use": "fill.mine"},
    }
    third = edit.add_alternative(rival, name, "third", {"use": "fill.third"})
    assert edit.remove_alternative(third, name, "third") == rival

    # an axis, a name, a wire
    axis = edit.set_axis(text, "order", {"range": [3, 9, 2]})
    assert data_of(axis)["axes"] == {**data["axes"], "order": {"range": [3, 9, 2]}}
    assert edit.unset(axis, ("axes", "order")) == text
    renamed = edit.rename(text, name, "renamed", registry=registry)
    assert edit.rename(renamed, "renamed", name, registry=registry) == text
    assert name not in data_of(renamed)["nodes"]
    wired = edit.connect(text, "error", "capture", registry=registry, port="estimate")
    expected = copy.deepcopy(data)
    expected["nodes"]["error"]["in"]["estimate"] = "capture"
    assert data_of(wired) == expected
    assert [len(lines) for lines in changed(text, wired)] == [1, 1]
    cut = edit.disconnect(text, "error", port="hidden")
    del expected["nodes"]["error"]["in"]["hidden"]
    assert data_of(cut)["nodes"]["error"]["in"] == {
        key: value for key, value in data["nodes"]["error"]["in"].items() if key != "hidden"
    }


VALUES: list[object] = [
    *("word", "two words", "", " ", "5", "1e-3", "null", "no", "~", "a: b", "a #b", "#", "- x"),
    *("é", "日本", "\u2028", "\x7f", "\ufeff", "tab\there", "[x]", "{x}", "*x", "&x", "!x", "%"),
    *("@", "it's", '"', "\\", "$length", "https://x/y#z", "one\ntwo", "one\n\ntwo\n\n"),
    *(" a\nb", "a\r\nb", "a\n", "\n", "---", "...", "a:", "a\n b\n"),
    *(0, -1, 10**20, 1e-12, 1e300, float("inf"), -float("inf"), True, False, None, 2.0),
    *([], {}, [[]], {"a": {}}, [{"a": [1, {"b": "c, d"}]}], {"k " + "x" * 60: ["y" * 60]}),
    {"first": "one\ntwo", "second": ["x" * 99, {"third": "y" * 99, "fourth": None}]},
]


@pytest.mark.parametrize("value", VALUES, ids=repr)
@pytest.mark.parametrize("place", ["axes", "title", "block", "flow", "list"])
def test_any_value_is_read_as_it_was_given(value: object, place: str) -> None:
    text = "nodegraph: 1\ntitle: x   # said\nnodes:\n  a:\n    with:\n      k: 1  # one\n"
    text += "  b: {use: x, with: {k: 1, l: 2}}\nreport:\n- a\n- b  # last"
    path: dict[str, tuple[str | int, ...]] = {
        "axes": ("axes", "new"),
        "title": ("title",),
        "block": ("nodes", "a", "with", "k"),
        "flow": ("nodes", "b", "with", "k"),
        "list": ("report", 1),
    }
    after = edit.set_value(text, path[place], value)
    read = read_yaml(after, "x").plain()
    for key in path[place]:
        read = read[key]
    assert type(read) is type(value)
    assert read == value
    assert after.count("# ") == text.count("# ")


def test_what_is_shared_is_not_changed_for_one_of_its_places(registry: Registry) -> None:
    text = "nodegraph: 1\nnodes:\n  a: {with: &w {k: 1}}\n  b: {with: *w}\n  c: {with: *w}\n"
    with pytest.raises(GraphError) as caught:
        edit.set_value(text, ("nodes", "a", "with", "k"), 2, file="g.yaml")
    assert str(caught.value).startswith("g.yaml:3:13: &w is used again in line 4, 5")
    with pytest.raises(GraphError, match=r"4:13: \*w stands for what is written in line 3"):
        edit.set_value(text, ("nodes", "b", "with", "k"), 2)
    with pytest.raises(GraphError, match=r"&w is used again"):
        edit.remove_node(text, "a", registry=registry)
    written_out = edit.set_value(text, ("nodes", "b", "with"), {"k": 2})
    assert changed(text, written_out) == (["  b: {with: *w}\n"], ["  b: {with: {k: 2}}\n"])


REFUSED = {
    "no such node": lambda reg: edit.unset(FILL, ("nodes", "fil")),
    "a name that is taken": lambda reg: edit.add_node(FILL, "a", {"use": "x"}),
    "no name": lambda reg: edit.rename(FILL, "a", "5 mm", registry=reg),
    "a name that nothing has": lambda reg: edit.rename(FILL, "b", "c", registry=reg),
    "a node that others read": lambda reg: edit.remove_node(FILL, "a", registry=reg),
    "a second of one label": lambda reg: edit.add_alternative(FILL, "fill", "muscle", {"use": "x"}),
    "no alternative": lambda reg: edit.remove_alternative(FILL, "fill", "muscle"),
    "a port of an unknown node": lambda reg: edit.connect(
        edit.add_node(FILL, "x", {"use": "un.known", "in": "a"}),
        "x",
        "fill",
        registry=reg,
        port="other",
    ),
    "a setting of a word": lambda reg: edit.set_value(FILL, ("nodes", "fill", "use", "x"), 1),
    "no YAML": lambda reg: edit.set_value("a: [", ("a",), 1),
    "an entry with a comment behind it": lambda reg: edit.unset(
        "nodegraph: 1\nreport:\n- show: a\n  # why\n  title: x\n", ("report", 0, "show")
    ),
}


@pytest.mark.parametrize("why", REFUSED)
def test_an_edit_that_cannot_be_is_refused_with_its_place(why: str, registry: Registry) -> None:
    with pytest.raises(GraphError) as caught:
        REFUSED[why](registry)
    problem = caught.value.problems[0]
    assert problem.message
    assert problem.place.line >= 1


def test_references_to_a_node_are_named_where_it_cannot_go(registry: Registry) -> None:
    with pytest.raises(GraphError, match=r"graph:4:32: 'a' feeds fill\n +disconnect these first"):
        edit.remove_node(FILL, "a", registry=registry)


def test_axes_in_answers_and_inner_axes_are_renamed(registry: Registry) -> None:
    text = (
        "nodegraph: 1\nnodes:\n  clean: {use: parts/x.yaml, in: a}\n  t: {use: compare.table,"
        " in: {from: clean, at: {clean.despike: x}},"
        " with: {compare: clean.despike, metric: clean}}\n"
        "report:\n- {show: t, answer: 'The clean way: {best at clean.despike=x, a=clean}.'}\n"
    )
    after = edit.rename(text, "clean", "tidy", registry=registry)
    assert data_of(after)["nodes"]["t"] == {
        "use": "compare.table",
        "in": {"from": "tidy", "at": {"tidy.despike": "x"}},
        "with": {"compare": "tidy.despike", "metric": "clean"},
    }
    answer = data_of(after)["report"][0]["answer"]
    assert answer == "The clean way: {best at tidy.despike=x, a=clean}."


MOVED = {
    "with alternatives": ("fill", ["noise", "gaps", "fill"], "damaged"),
    "a family": ("fill", ["fill"], "filled"),
    "in flow": ("fill", ["error"], "scored"),
    "without a port": ("fill", ["capture", "truth", "noise"], "source"),
    "a chain": ("pipeline", ["tracks", "named", "fill", "despike", "smooth"], "clean"),
}


@pytest.mark.parametrize("study", MOVED)
def test_nodes_in_a_graph_of_their_own_do_the_same(study: str, registry: Registry) -> None:
    stem, nodes, name = MOVED[study]
    path = ROOT / "graphs" / f"{stem}.yaml"
    text, file = text_of(path), "parts/new.yaml"
    outer, inner = edit.move_to_graph(text, nodes, name, file, registry=registry)
    before = build(read_graph_text(text, path.name, path.parent), registry)
    after = build(read_graph_text(outer, path.name, path.parent, {file: inner}), registry)
    names = {axis: f"{name}.{axis}" for axis in nodes}
    for node in before.nodes.values():
        moved = after.nodes[names.get(node.name, node.name)]
        assert moved.axes == tuple(names.get(axis, axis) for axis in node.axes)
        assert moved.methods.keys() == node.methods.keys()
    assert comments(outer) + comments(inner) == comments(text)


def test_nodes_that_cannot_go_alone_stay(registry: Registry) -> None:
    text = text_of(ROOT / "graphs" / "fill.yaml")
    with pytest.raises(GraphError, match="'fill' reads nodes that go, and feeds error"):
        edit.move_to_graph(text, ["gaps", "error"], "x", "x.yaml", registry=registry)
    with pytest.raises(GraphError, match="table names the axis 'terms', which stays outside"):
        edit.move_to_graph(text, ["error", "table"], "x", "x.yaml", registry=registry)
    with pytest.raises(GraphError, match=r"'x\.txt' is no name of a graph file"):
        edit.move_to_graph(text, ["error"], "x", "x.txt", registry=registry)
    with pytest.raises(GraphError, match="'fill' is a name already"):
        edit.move_to_graph(text, ["error"], "fill", "x.yaml", registry=registry)
