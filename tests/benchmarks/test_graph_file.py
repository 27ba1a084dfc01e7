"""Reading and checking a graph file with places, beside a YAML loader that only reads."""

from __future__ import annotations

import pytest
import yaml

from nodegraph import node
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plugin.registry import Registry
from tests.benchmarks.conftest import Clock
from tests.benchmarks.engines.ours import HERE

COUNT = 1000
CASE = "graph file of 1,000 nodes with settings, a line per part"
COLUMN = "us/node"


@node("file.first")
def first() -> float:
    return 0.0


@node("file.step")
def step(value: float, *, amount: float = 1.0, times: int = 1, name: str = "") -> float:
    return value + amount * times


def written() -> str:
    lines = ["nodegraph: 1", "nodes:", "  n0: {use: file.first}"]
    for at in range(COUNT):
        lines += [f"  n{at + 1}:", "    use: file.step", f"    in: n{at}"]
        lines += [f"    with: {{amount: 0.5, times: {at}, name: marker_{at}}}"]
    return "\n".join([*lines, ""])


TEXT = written()
REGISTRY = Registry.of([first, step])


def test_read_and_check(clock: Clock) -> None:
    def both() -> object:
        return build(read_graph_text(TEXT, "file.yaml", HERE), REGISTRY)

    graph = clock(CASE, "nodegraph", COLUMN, both, per=COUNT)
    assert len(graph.nodes) == COUNT + 1
    assert graph.nodes["n3"].place.line == 4 + 4 * 2 + 1  # below its name


def test_read(clock: Clock) -> None:
    def read() -> object:
        return read_graph_text(TEXT, "file.yaml", HERE)

    spec = clock(CASE, "nodegraph, read alone", COLUMN, read, per=COUNT)
    assert len(spec.nodes) == COUNT + 1


def test_check(clock: Clock) -> None:
    spec = read_graph_text(TEXT, "file.yaml", HERE)
    graph = clock(CASE, "nodegraph, check alone", COLUMN, lambda: build(spec, REGISTRY), per=COUNT)
    assert len(graph.nodes) == COUNT + 1


@pytest.mark.parametrize("name", ["CSafeLoader", "SafeLoader"])
def test_yaml(name: str, clock: Clock) -> None:
    loader = getattr(yaml, name)

    def load() -> object:
        return yaml.load(TEXT, loader)

    plain = clock(CASE, f"yaml.{name}, no check", COLUMN, load, per=COUNT)
    assert plain["nodes"]["n3"]["with"] == {"amount": 0.5, "times": 2, "name": "marker_2"}
