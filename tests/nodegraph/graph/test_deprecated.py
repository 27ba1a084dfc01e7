"""What is deprecated works, and whoever uses it is told where, and what to use instead."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import pytest

from nodegraph import Deprecated, Unit, node
from nodegraph.api import load
from nodegraph.execute import Run
from nodegraph.graph import Graph
from nodegraph.node.decorator import node_of
from nodegraph.node.description import describe_settings, summary_of
from nodegraph.report.notes import step_notes
from nodegraph.runs.settings import RunSettings


@node("fill.old", deprecated="use fill.hold")
def old(recording: float, *, max_gap: int | None = None) -> float:
    """Add two."""
    return recording + 2.0


@node("fill.renamed")
def renamed(
    recording: float,
    *,
    max_gap: int | None = None,
    longest: Annotated[int | None, Deprecated("use max_gap"), Unit("frames")] = None,
    within: Annotated[int, Deprecated("leave it out")] | None = None,
) -> float:
    """Add three.

    Parameters
    ----------
    max_gap
        The longest gap.
    longest
        The longest gap.
    within
        Nothing.
    """
    return recording + 3.0


@node("gone.one", deprecated="use fill.hold")
def gone(recording: float) -> float:
    return recording


def told(graph: Graph) -> list[str]:
    return [str(one) for one in graph.notices]


def test_what_is_not_deprecated_is_not_told(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {a: {use: read.number}, b: {in: a, alternatives: [fill.hold, fill.renamed]}}"
    assert told(graph_of(text, more=[renamed])) == []


def test_a_node_is_told_with_its_place(graph_of: Callable[..., Graph]) -> None:
    text = """\
    nodes:
      a: {use: read.number}
      b: {use: fill.old, in: a}
      c: {in: a, alternatives: {new: fill.hold, before: {use: fill.old}}}
    """
    assert told(graph_of(text, more=[old])) == [
        "toy.yaml:4:12: b: fill.old is deprecated\n    use fill.hold",
        "toy.yaml:5:59: c (before): fill.old is deprecated\n    use fill.hold",
    ]


def test_a_label_that_is_not_run_is_not_told(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: [fill.hold, fill.old]}}"
    assert told(graph_of(text, more=[old], only={"c": ["hold"]})) == []
    assert len(told(graph_of(text, more=[old]))) == 1


def test_a_setting_is_told_with_its_place(graph_of: Callable[..., Graph]) -> None:
    text = """\
    inputs: {most: 9}
    nodes:
      a: {use: read.number}
      b: {use: fill.renamed, in: a, with: {max_gap: 3, longest: $most, within: 2}}
    """
    assert told(graph_of(text, more=[renamed])) == [
        "toy.yaml:5:61: b: setting 'longest' of fill.renamed is deprecated\n    use max_gap",
        "toy.yaml:5:76: b: setting 'within' of fill.renamed is deprecated\n    leave it out",
    ]


def test_a_family_leaves_out_what_is_deprecated_and_says_so(
    graph_of: Callable[..., Graph],
) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: fill.*}}"
    graph = graph_of(text, more=[old, renamed])
    assert graph.axes["c"].labels == ("hold", "renamed", "scale")
    assert told(graph) == [
        "toy.yaml:2:57: c: fill.* leaves out fill.old, which is deprecated\n"
        "    use fill.hold; or list fill.old"
    ]


def test_a_label_brings_it_back_beside_its_family(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: {fill.*: , old: fill.old}}}"
    graph = graph_of(text, more=[old])
    assert set(graph.axes["c"].labels) == {"hold", "scale", "old"}


def test_a_family_of_which_all_is_deprecated_is_a_mistake(
    mistakes_of: Callable[..., list[object]],
) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: @@gone.*}}"
    [problem] = mistakes_of(text, more=[gone])
    assert "all nodes of 'gone.*' are deprecated" in str(problem)
    assert "gone.one: use fill.hold" in str(problem)


def test_it_runs_as_before_and_the_report_tells(run_of: Callable[..., Run]) -> None:
    run = run_of("nodes: {a: {use: read.number}, b: {use: fill.old, in: a}}", more=[old])
    assert run["b"].value == 3.0
    [note] = step_notes(run, RunSettings("toy.yaml"))
    assert (note.kind, note.node) == ("warning", "toy.yaml:2:41")
    assert note.reason == "b: fill.old is deprecated: use fill.hold"


def test_people_read_it_with_the_setting_and_the_node() -> None:
    described, one = node_of(renamed), node_of(old)
    assert described is not None
    assert one is not None
    meanings = {one.name: one.meaning for one in describe_settings(described)}
    assert meanings["longest"] == "(deprecated: use max_gap) The longest gap."
    assert meanings["max_gap"] == "The longest gap."
    assert summary_of(one) == "(deprecated: use fill.hold) Add two."
    assert summary_of(described) == "Add three."


def test_loading_from_python_warns(tmp_path: Path) -> None:
    (tmp_path / "old_nodes.py").write_text(
        "from nodegraph import node\n"
        "@node('toy.old', deprecated='use toy.new')\n"
        "def old() -> float:\n    return 1.0\n"
    )
    (tmp_path / "g.yaml").write_text("nodegraph: 1\nnodes: {a: {use: toy.old}}\n")
    with pytest.warns(UserWarning, match=r"g\.yaml:2:18: a: toy\.old is deprecated\n    use toy"):
        load(tmp_path / "g.yaml", plugins=[tmp_path / "old_nodes.py"])
