"""Choices of inputs, axes and labels."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nodegraph import GraphError
from nodegraph.graph import Graph

TEXT = """
inputs: {start: 3}
axes: {k: [1, 2, 3], actor: {ME: 10, MB: 20}}
nodes:
  a: {use: read.number, with: {start: $start}}
  b: {use: gaps.cut, in: a, with: {length: $k, seed: $actor}}
  fill: {in: b, alternatives: fill.*}
"""


def labels(graph: Graph) -> dict[str, tuple[object, ...]]:
    return {name: axis.labels for name, axis in graph.axes.items()}


def test_only_keeps_labels_in_the_order_of_the_file(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(TEXT, only={"k": (3, 1), "fill": ("scale",)})
    assert labels(graph) == {"k": (1, 3), "actor": ("ME", "MB"), "fill": ("scale",)}
    assert graph.axes["k"].removed == {2}
    assert list(graph.nodes["fill"].methods) == ["scale"]


@pytest.mark.parametrize(
    ("axis", "expected"),
    [
        ([7, 8], (7, 8)),
        (range(2, 4), (2, 3)),
        ((9,), (9,)),
        ({"x": 5, "y": 6}, ("x", "y")),
        ({"range": [2, 6, 2]}, (2, 4, 6)),
    ],
)
def test_an_axis_may_be_set_in_every_form(
    graph_of: Callable[..., Graph], axis: object, expected: tuple[object, ...]
) -> None:
    assert labels(graph_of(TEXT, axes={"k": axis}))["k"] == expected


def test_axis_and_only_work_together(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(TEXT, axes={"k": [3, 4, 5]}, only={"k": (4,)})
    assert labels(graph)["k"] == (4,)
    assert graph.axes["k"].removed == {1, 2, 3, 5}


def test_an_input_may_become_an_axis(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(TEXT, axes={"start": {"low": 1, "high": 9}})
    assert labels(graph)["start"] == ("low", "high")
    assert "start" not in graph.inputs
    settings = graph.nodes["a"].first.settings
    assert settings.values == {("low",): {"start": 1.0}, ("high",): {"start": 9.0}}
    with pytest.raises(GraphError, match=r"--set start: 'start' is set, and is an axis"):
        graph_of(TEXT, axes={"start": [1]}, inputs={"start": 2})


def test_an_input_may_be_set(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(TEXT, inputs={"start": 9})
    assert graph.nodes["a"].first.settings.values[()] == {"start": 9.0}
    assert graph.inputs == {"start": 9}


@pytest.mark.parametrize(
    ("choices", "expected"),
    [
        (
            {"inputs": {"strat": 1}},
            "--set strat: the graph has no input 'strat'\n    did you mean 'start'?",
        ),
        ({"inputs": {"k": 5}}, "--set k: 'k' is an axis\n    write --axis k=5"),
        ({"inputs": {"fill": "x"}}, "--set fill: 'fill' is a node\n    write --only fill=x"),
        (
            {"inputs": {"a.start": 2}},
            "--set a.start: 'a.start' is a setting of a node, and the graph has no such input\n"
            "    write with: {start: 2} at the node, or make it an input",
        ),
        ({"axes": {"kk": [1]}}, "--axis kk: the graph has no axis 'kk'"),
        ({"axes": {"k": 1}}, "--axis k: an axis cannot be 1"),
        ({"axes": {"k": []}}, "--axis k: axis 'k' has no label"),
        ({"axes": {"k": [1, 1]}}, "--axis k: axis 'k' has the label 1 twice"),
        ({"axes": {"fill": [1]}}, "--axis fill: 'fill' is a node\n    write --only fill=..."),
        ({"axes": {"a": [1]}}, "--axis a: the graph has no axis 'a'"),
        ({"only": {"kk": (1,)}}, "--only kk: the graph has no axis 'kk'"),
        ({"only": {"a": (1,)}}, "--only a: the graph has no axis 'a'"),
        ({"only": {"k": (9,)}}, "--only k: no label 9\n    there is: 1, 2, 3"),
        ({"only": {"k": ("1",)}}, "--only k: no label '1'"),
        ({"axes": {"k": {"count": 1}}}, "greater than or equal to 1, got 0"),
        ({"only": {"k": ()}}, "--only k: no label is kept\n    there is: 1, 2, 3"),
        ({"only": {"fill": ()}}, "--only fill: no label is kept"),
        ({"inputs": {"start": "x"}}, "should be a valid number, got 'x'"),
    ],
)
def test_a_wrong_choice_is_reported_with_its_option(
    graph_of: Callable[..., Graph], choices: dict[str, object], expected: str
) -> None:
    with pytest.raises(GraphError) as caught:
        graph_of(TEXT, **choices)
    assert expected in str(caught.value)
    assert len(caught.value.problems) == 1


def test_a_wrong_value_is_reported_at_its_option(graph_of: Callable[..., Graph]) -> None:
    text = """
        inputs: {start: 1.0, path: a.txt}
        axes: {length: [5]}
        nodes:
          one: {use: read.number, with: {start: $start}}
          two: {use: read.file, with: {path: $path}}
          cut: {use: gaps.cut, in: one, with: {length: $length}}
    """
    choices = {"inputs": {"start": "word", "path": "none.txt"}, "axes": {"length": [5, 0]}}
    with pytest.raises(GraphError) as caught:
        graph_of(text, **choices)
    problems = [str(problem.place) for problem in caught.value.problems]
    assert problems == ["--axis length", "--set path", "--set start"]
