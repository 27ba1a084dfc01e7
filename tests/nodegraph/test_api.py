from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.api import reported
from nodegraph.execute import Event
from nodegraph.graph import Graph
from nodegraph.plugin import loading
from nodegraph.plugin.registry import Registry, default_registry

TEXT = """\
nodegraph: 1
inputs: {start: 3}
axes: {k: [1, 2], j: [3, 4]}
nodes:
  a: {use: read.number, with: {start: $start}}
  b: {use: gaps.cut, in: a, with: {length: $k, seed: $j}}
  fill: {in: b, alternatives: fill.*}
  table: {use: compare.table, in: fill}
  extra: {use: fill.hold, in: fill}
"""
FIVE_LINES = """\
from nodegraph import node
@node("fill.mine")
def mine(recording: float, *, max_gap: int | None = None) -> float:
    return recording * 100
"""


@pytest.fixture(autouse=True)
def _only_toys(monkeypatch: pytest.MonkeyPatch, toys: Registry) -> None:
    described = [one.node.function for one in toys]

    class Module:
        nodegraph_nodes = staticmethod(lambda: described)

    monkeypatch.setattr(loading, "installed", lambda: ([loading.Plugin("toys", Module)], []))
    default_registry.cache_clear()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "graph.yaml"
    path.write_text(TEXT)
    return path


def labels(graph: Graph) -> dict[str, tuple[object, ...]]:
    return {name: axis.labels for name, axis in graph.axes.items()}


def test_load_run_and_take_values(file: Path) -> None:
    graph = ng.load(file)
    run = ng.run(graph, axis={"k": [1]}, only={"fill": ["hold"], "j": 3})
    assert run["fill"].at(k=1, j=3, fill="hold") == pytest.approx(3.3)
    assert run["fill"].value == pytest.approx(3.3)
    assert len(run["table"].value.scores) == 1
    assert ng.get_node("fill.hold")(1.0) == 2.0


def test_a_path_runs_too(file: Path) -> None:
    assert ng.run(str(file), set={"start": 10}, executor="serial")["a"].value == 10


def test_what_is_chosen_in_running_comes_on_top_of_what_was_loaded(file: Path) -> None:
    graph = ng.load(file, set={"start": 10}, axis={"k": [7, 8]}, only={"j": [4]})
    run = ng.run(graph, only={"k": [8]})
    assert run["a"].value == 10
    assert labels(run.plan.graph) == {"k": (8,), "j": (4,), "fill": ("hold", "scale")}
    again = ng.run(graph, set={"start": 20}, axis={"k": [9]})
    assert again["a"].value == 20
    assert labels(again.plan.graph)["k"] == (9,)
    assert labels(graph)["k"] == (7, 8)


def test_a_word_alone_is_one_label(file: Path) -> None:
    assert labels(ng.load(file, only={"fill": "scale"}))["fill"] == ("scale",)


def test_a_file_of_five_lines_joins_its_family(file: Path, tmp_path: Path) -> None:
    plugin = tmp_path / "my_fill.py"
    plugin.write_text(FIVE_LINES)
    graph = ng.load(file, plugins=[plugin])
    assert labels(graph)["fill"] == ("hold", "mine", "scale")
    run = ng.run(graph, only={"fill": "mine", "k": 1, "j": 3})
    assert run["fill"].value == pytest.approx(230)
    assert ng.run(ng.load(file), plugins=[str(plugin)])["fill"].run.plan.graph.axes["fill"].labels


def test_listeners_hear_the_run(file: Path) -> None:
    events: list[Event] = []
    ng.run(file, listeners=[events.append], jobs=2)
    assert (events[0].kind, events[-1].kind) == ("planned", "finished")


def test_a_mistake_is_told_before_anything_runs(file: Path, calls: list[str]) -> None:
    file.write_text(TEXT.replace("fill.hold", "fill.hodl"))
    with pytest.raises(ng.GraphError, match=r"graph\.yaml:9:16: no node 'fill\.hodl'"):
        ng.run(file)
    assert calls == []
    with pytest.raises(ng.GraphError, match="no such graph file"):
        ng.load(file.with_name("grap.yaml"))


def test_what_is_reported(graph_of: Callable[..., Graph]) -> None:
    text = TEXT.partition("\n")[2]
    assert reported(graph_of(text)) == ("table", "extra")
    assert reported(graph_of(f"{text}report: [fill, b.truth, b]")) == ("fill", "b")


def test_every_public_name_is_there() -> None:
    assert all(getattr(ng, name) is not None for name in ng.__all__)
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = ng.nothing
