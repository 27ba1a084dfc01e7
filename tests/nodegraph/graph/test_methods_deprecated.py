"""Deprecated nodes and settings work, with a notice of the place and of what to use instead."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import pytest

from nodegraph import Deprecated, Unit, node
from nodegraph.api import load
from nodegraph.execute.results import Run
from nodegraph.graph import Graph
from nodegraph.node.decorator import node_of
from nodegraph.node.description import describe_settings, summary_of
from nodegraph.report.notes import step_notes


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


def notices(graph: Graph) -> list[str]:
    return [str(notice) for notice in graph.notices]


def test_nothing_is_reported_without_deprecated_parts(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {a: {use: read.number}, b: {in: a, alternatives: [fill.hold, fill.renamed]}}"
    assert notices(graph_of(text, more=[renamed])) == []


def test_a_deprecated_node_is_reported_with_its_place(graph_of: Callable[..., Graph]) -> None:
    text = """\
    nodes:
      a: {use: read.number}
      b: {use: fill.old, in: a}
      c: {in: a, alternatives: {new: fill.hold, before: {use: fill.old}}}
    """
    assert notices(graph_of(text, more=[old])) == [
        "toy.yaml:4:12: b: fill.old is deprecated\n    use fill.hold",
        "toy.yaml:5:59: c (before): fill.old is deprecated\n    use fill.hold",
    ]


def test_a_label_that_is_not_run_is_not_reported(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: [fill.hold, fill.old]}}"
    assert notices(graph_of(text, more=[old], only={"c": ["hold"]})) == []
    assert len(notices(graph_of(text, more=[old]))) == 1


def test_a_deprecated_setting_is_reported_with_its_place(graph_of: Callable[..., Graph]) -> None:
    text = """\
    inputs: {most: 9}
    nodes:
      a: {use: read.number}
      b: {use: fill.renamed, in: a, with: {max_gap: 3, longest: $most, within: 2}}
    """
    assert notices(graph_of(text, more=[renamed])) == [
        "toy.yaml:5:61: b: setting 'longest' of fill.renamed is deprecated\n    use max_gap",
        "toy.yaml:5:76: b: setting 'within' of fill.renamed is deprecated\n    leave it out",
    ]


def test_a_family_leaves_out_deprecated_methods_with_a_notice(
    graph_of: Callable[..., Graph],
) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: fill.*}}"
    graph = graph_of(text, more=[old, renamed])
    assert graph.axes["c"].labels == ("hold", "renamed", "scale")
    assert notices(graph) == [
        "toy.yaml:2:57: c: fill.* leaves out fill.old, which is deprecated\n"
        "    use fill.hold; or list fill.old"
    ]


def test_a_label_adds_a_deprecated_method_to_its_family(graph_of: Callable[..., Graph]) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: {fill.*: , old: fill.old}}}"
    graph = graph_of(text, more=[old])
    assert set(graph.axes["c"].labels) == {"hold", "scale", "old"}


def test_a_family_of_deprecated_methods_alone_is_an_error(
    problems_of: Callable[..., list[object]],
) -> None:
    text = "nodes: {a: {use: read.number}, c: {in: a, alternatives: @@gone.*}}"
    [problem] = problems_of(text, more=[gone])
    assert "all nodes of 'gone.*' are deprecated" in str(problem)
    assert "gone.one: use fill.hold" in str(problem)


def test_it_runs_as_before_with_a_notice_in_the_report(run_of: Callable[..., Run]) -> None:
    run = run_of("nodes: {a: {use: read.number}, b: {use: fill.old, in: a}}", more=[old])
    assert run["b"].value == 3.0
    [note] = step_notes(run)
    assert (note.kind, note.node) == ("warning", "toy.yaml:2:41")
    assert note.reason == "b: fill.old is deprecated: use fill.hold"


def test_descriptions_name_deprecated_settings_and_nodes() -> None:
    described, old_node = node_of(renamed), node_of(old)
    assert described is not None
    assert old_node is not None
    meanings = {setting.name: setting.meaning for setting in describe_settings(described)}
    assert meanings["longest"] == "(deprecated: use max_gap) The longest gap."
    assert meanings["max_gap"] == "The longest gap."
    assert summary_of(old_node) == "(deprecated: use fill.hold) Add two."
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
