"""Order, types and wires of a graph, and nodes that are left out."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import networkx as nx
import pytest

from nodegraph import node
from nodegraph.graph import Gather, Graph
from tests.nodegraph.conftest import ProblemsOf

GOOD = """\
inputs: {start: 3}
axes:
  trial: {count: 3}
  length: [5, 15, 45]
nodes:
  capture: {use: read.number, with: {start: $start}}
  gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
  fill:
    in: gaps.gappy
    alternatives: {fill.*: {}, strong: {use: fill.scale, with: {power: 3}}, pass: {}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error}
report: [table]
"""


def test_a_good_graph_is_typed_and_in_order(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(GOOD)
    assert list(graph.nodes) == ["capture", "gaps", "fill", "error", "table"]
    assert {name: node.axes for name, node in graph.nodes.items()} == {
        "capture": (),
        "gaps": ("trial", "length"),
        "fill": ("trial", "length", "fill"),
        "error": ("trial", "length", "fill"),
        "table": (),
    }
    assert graph.nodes["table"].gathered == ("trial", "length", "fill")
    assert list(graph.nodes["fill"].methods) == ["hold", "scale", "strong", "pass"]
    assert isinstance(graph.nodes["table"].first.inputs["scores"], Gather)
    assert graph.inputs == {"start": 3}
    assert graph.left_out == ()


def test_a_node_may_be_written_before_what_feeds_it(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of("nodes: {b: {use: fill.hold, in: a}, a: {use: read.number}}")
    assert list(graph.nodes) == ["a", "b"]


def test_the_network_has_records_at_nodes_and_edges(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(GOOD)
    assert list(graph.network) == ["capture", "gaps", "fill", "error", "table"]
    assert graph.network.nodes["gaps"]["record"] is graph.nodes["gaps"]
    assert nx.ancestors(graph.network, "fill") == {"capture", "gaps"}
    wires = {
        (source, wire.output, target, wire.port, wire.gathers)
        for source, target, wire in graph.wires()
    }
    assert wires == {
        ("capture", "output", "gaps", "recording", False),
        ("gaps", "gappy", "fill", "recording", False),
        ("fill", "output", "error", "estimate", False),
        ("gaps", "truth", "error", "truth", False),
        ("gaps", "hidden", "error", "hidden", False),
        ("error", "output", "table", "scores", True),
    }
    ((_, _, wire),) = (each for each in graph.wires() if each[1] == "gaps")
    assert str(wire.reference.place) == "toy.yaml:8:29"


def test_the_network_cannot_be_changed(graph_of: Callable[..., Graph]) -> None:
    with pytest.raises(nx.NetworkXError, match=r"[Ff]rozen"):
        graph_of(GOOD).network.remove_node("fill")


def test_one_node_may_read_another_several_times(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(
        """
        axes: {k: [1, 2]}
        nodes:
          a: {use: read.number, with: {start: $k}}
          b:
            use: plot.stages
            in: {recordings: {x: {from: a, at: {k: 1}}, y: {from: a, at: {k: 2}}}}
        """
    )
    assert [wire.reference.at for _, _, wire in graph.wires()] == [{"k": 1}, {"k": 2}]


def test_a_subclass_fits_and_nothing_is_converted(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    class Fine(float):
        pass

    def fine() -> float:
        return Fine(1)

    fine.__annotations__["return"] = Fine
    read_fine = node("read.fine")(fine)
    assert graph_of("nodes: {a: {use: read.fine}, b: {use: fill.hold, in: a}}", more=[read_fine])
    problems_of(
        """
        nodes:
          a: {use: read.number}
          b: {use: gaps.cut, in: a}
          c: {use: fill.hold, in: @@b.hidden}
        """
    )


def test_a_label_that_was_removed_leaves_the_node_and_its_readers_out(
    graph_of: Callable[..., Graph],
) -> None:
    fixed = "{use: strict.positive, in: {from: fill, at: {fill: hold, trial: 0, length: 45}}}"
    stages = "{recordings: {x: capture, y: {from: fill, at: {length: 5}}}}"
    more = f"""\
  one: {fixed}
  two: {{use: fill.hold, in: one}}
  shown: {{use: plot.stages, in: {stages}}}
report: [table]
"""
    text = GOOD.replace("report: [table]\n", more)
    assert graph_of(text).left_out == ()
    graph = graph_of(text, only={"length": (5, 15)})
    assert [(item.node, item.reason) for item in graph.left_out] == [
        ("one", "the command has removed length=45"),
        ("two", "no input from one"),
    ]
    assert list(graph.nodes) == ["capture", "gaps", "fill", "error", "table", "shown"]
    graph = graph_of(text, axes={"length": [45, 90]})
    assert [item.node for item in graph.left_out] == ["shown"]
    graph = graph_of(text, only={"fill": ("scale",)})
    assert [item.node for item in graph.left_out] == ["one", "two"]


def test_the_first_label_is_that_of_the_command(graph_of: Callable[..., Graph]) -> None:
    fixed = "{from: fill, at: {fill: $first, trial: $first, length: $first}}"
    text = GOOD.replace(
        "report: [table]\n",
        f"  one: {{use: fill.hold, in: {fixed}}}\n"
        f"  shown: {{use: plot.stages, in: {{recordings: {{x: {fixed}}}}}}}\nreport: [table]\n",
    )
    for choices, expected in (
        ({}, {"fill": "hold", "trial": 0, "length": 5}),
        (
            {"axes": {"length": [90, 45]}, "only": {"fill": ("scale",)}},
            {"fill": "scale", "trial": 0, "length": 90},
        ),
    ):
        graph = graph_of(text, **choices)
        assert graph.left_out == ()
        for name in ("one", "shown"):
            (method,) = graph.nodes[name].methods.values()
            (source,) = method.references()
            assert source.at == expected


def test_a_file_may_lie_beside_the_graph(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf, tmp_path: Path
) -> None:
    (tmp_path / "take.txt").write_text("1.5")
    text = "nodes: {a: {use: read.file, with: {path: take.txt}}}"
    settings = graph_of(text).nodes["a"].first.settings
    assert settings.values[()]["path"] == (tmp_path / "take.txt").resolve()
    assert settings.shown[()]["path"] == "take.txt"
    problems = problems_of(text.replace("take.txt", "@@tak.txt"))
    assert problems[0].message == "a: no such file: tak.txt"
    assert problems[0].instead.startswith("did you mean 'take.txt'?")
    assert "no such file" in problems_of(text.replace("take.txt", "@@" + "x" * 5000))[0].message


def test_a_graph_has_no_values_and_says_which_object_has(graph_of: Callable[..., Graph]) -> None:
    with pytest.raises(TypeError, match=r"nodegraph\.run\(graph\)\['n'\] has them"):
        graph_of("nodes: {n: {use: read.number}}")["n"]
