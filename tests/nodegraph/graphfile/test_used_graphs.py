"""Reading a graph file reads those that it uses, each once, wherever they lie."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph import GraphError
from nodegraph.graphfile import GraphSpec, read_graph_file, read_graph_text

USE = (
    "nodegraph: 1\nnodes: {{a: {{use: {0}}}, b: {{use: {0}}}, c: {{use: x.y}}}}\noutputs: {{a: a}}"
)
LEAF = "nodegraph: 1\nnodes: {a: {use: x.y}}\noutputs: {a: a}\n"


def write(folder: Path, **texts: str) -> None:
    for name, text in texts.items():
        path = folder / f"{name.replace('__', '/')}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def messages(spec: GraphSpec) -> list[str]:
    return [str(problem).partition("\n")[0] for problem in spec.problems]


def test_all_files_are_read_once_with_what_they_use(tmp_path: Path) -> None:
    write(
        tmp_path,
        graphs__outer=USE.format("../shared/middle.yaml"),
        shared__middle=USE.format("./leaf.yml"),
    )
    (tmp_path / "shared" / "leaf.yml").write_text(LEAF)
    spec = read_graph_file(tmp_path / "graphs" / "outer.yaml")
    middle, leaf = (tmp_path / "shared" / name for name in ("middle.yaml", "leaf.yml"))
    assert not spec.problems
    assert spec.uses == {"../shared/middle.yaml": middle}
    assert set(spec.graphs) == {middle, leaf}
    assert spec.graphs[middle].uses == {"./leaf.yml": leaf}
    assert spec.graphs[leaf].folder == tmp_path / "shared"
    assert spec.included == {
        "../shared/leaf.yml": LEAF,
        "../shared/middle.yaml": middle.read_text(),
    }
    assert spec.graphs[leaf].file == str(leaf)


def test_a_file_is_named_as_seen_from_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, graphs__outer=USE.format("../shared/leaf.yaml"), shared__leaf=LEAF)
    monkeypatch.chdir(tmp_path)
    spec = read_graph_file(Path("graphs/outer.yaml"))
    assert [used.file for used in spec.graphs.values()] == ["shared/leaf.yaml"]


def test_a_graph_without_others_has_none() -> None:
    spec = read_graph_text(LEAF, "t.yaml", Path("nowhere"))
    assert (spec.uses, spec.graphs, spec.included, spec.written) == ({}, {}, {}, None)


def test_an_unreadable_file_is_an_error_at_each_use(tmp_path: Path) -> None:
    write(tmp_path, outer=USE.format("leef.yaml"), leaf=LEAF)
    spec = read_graph_file(tmp_path / "outer.yaml")
    assert [(problem.place.line, problem.place.column) for problem in spec.problems] == [
        (2, 18),
        (2, 39),
    ]
    assert {problem.message for problem in spec.problems} == {"leef.yaml: no such graph file"}
    assert {problem.instead for problem in spec.problems} == {
        "did you mean 'leaf.yaml'? in that folder there is: leaf.yaml, outer.yaml"
    }
    assert not spec.uses


def test_a_file_that_is_not_yaml_is_one_error_at_its_own_place(tmp_path: Path) -> None:
    write(tmp_path, outer=USE.format("leaf.yaml"), leaf="nodegraph: 1\nnodes: [}\n")
    spec = read_graph_file(tmp_path / "outer.yaml")
    assert [str(problem.place) for problem in spec.problems] == [f"{tmp_path / 'leaf.yaml'}:2:9"]


def test_errors_of_a_used_graph_stay_with_it(tmp_path: Path) -> None:
    write(tmp_path, outer=USE.format("leaf.yaml"), leaf=LEAF + "titel: x\n")
    spec = read_graph_file(tmp_path / "outer.yaml")
    assert not spec.problems
    assert [problem.message for problem in spec.graphs[tmp_path / "leaf.yaml"].problems] == [
        "unknown key 'titel'"
    ]


def test_a_circle_is_cut_where_it_closes(tmp_path: Path) -> None:
    outer, other = USE.format("other.yaml"), USE.format("outer.yaml").replace("b: {use", "d: {use")
    write(tmp_path, outer=outer, other=other)
    spec = read_graph_file(tmp_path / "outer.yaml")
    way = " -> ".join(str(tmp_path / f"{name}.yaml") for name in ("outer", "other", "outer"))
    assert {problem.message for problem in spec.problems} == {
        f"{tmp_path / 'outer.yaml'} uses itself: {way}"
    }
    assert {problem.place.file for problem in spec.problems} == {str(tmp_path / "other.yaml")}
    assert spec.uses
    assert not spec.graphs[tmp_path / "other.yaml"].uses


def test_too_many_labels_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("nodegraph.graphfile.reader.MOST_LABELS", 50_000)
    axes = "axes: {a: {count: 10000}, b: {count: 10000}}\n"
    nodes = ", ".join(f"n{index}: {{use: leaf.yaml}}" for index in range(3))
    write(tmp_path, outer=f"nodegraph: 1\nnodes: {{{nodes}}}\n", leaf=LEAF + axes)
    (problem,) = read_graph_file(tmp_path / "outer.yaml").problems
    assert problem.message.startswith("leaf.yaml: more than 50,000 labels")
    assert problem.place.column == nodes.rindex("leaf") + len("nodes: {") + 1


def test_a_list_of_alternatives_labels_a_graph_with_its_stem() -> None:
    text = "nodegraph: 1\nnodes: {a: {alternatives: [./sub/my.clean.yaml, x.b, ../c.yml]}}"
    methods = read_graph_text(text, "t.yaml", Path("nowhere")).nodes["a"].methods
    assert [(method.label, method.is_graph) for method in methods] == [
        ("my.clean", True),
        ("b", False),
        ("c", True),
    ]


def test_a_duplicate_key_hides_no_other_error() -> None:
    text = "nodegraph: 1\ntitle: a\ntitle: b\nnodes: {a: {sue: x.y}, a: {use: x.y}}\n"
    spec = read_graph_text(text, "t.yaml", Path())
    assert messages(spec) == [
        "t.yaml:3:1: duplicate key 'title'; first in line 2",
        "t.yaml:4:24: duplicate key 'a'; first in line 4",
        "t.yaml:4:13: node 'a': unknown key 'sue'",
        "t.yaml:4:12: node 'a' needs 'use' or 'alternatives'",
    ]
    assert spec.title == "a"
    for rest in ("b: [}", "b: *c", "? [b]: c"):
        with pytest.raises(GraphError) as caught:
            read_graph_text(f"a: 1\na: 2\n{rest}", "t.yaml", Path())
        assert [problem.place.line for problem in caught.value.problems] == [2, 3]
