"""nodegraph: from the text of a graph file to values."""

from __future__ import annotations

from pathlib import Path

import nodegraph as ng
from nodegraph import node
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.resume import open_store
from nodegraph.execute.run import execute
from nodegraph.graph import build as build_graph
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry
from tests.benchmarks.work import Build, Engine, Run, Work

HERE = Path()


def chain_text(count: int) -> str:
    """Return the text of a chain of so many steps, one line each."""
    lines = [f"  n{at + 1}: {{use: bench.step, in: n{at}}}" for at in range(count)]
    return "\n".join(["nodegraph: 1", "nodes:", "  n0: {use: bench.first}", *lines, ""])


def registry_of(work: Work) -> Registry:
    return Registry.of([node("bench.first")(work.first), node("bench.step")(work.step)])


def nodegraph(executor: str) -> Engine:
    """Return the engine with one of its executors, as `nodegraph.run` has it.

    Its build reads and checks the whole text; its run plans the steps, too.
    """

    def prepare(work: Work, count: int) -> Build:
        text, registry = chain_text(count), registry_of(work)

        def build() -> Run:
            graph = build_graph(read_graph_text(text, "chain.yaml", HERE), registry)

            def run() -> object:
                return ng.run(graph, executor=executor, cache=False)[f"n{count}"].value

            return run

        return build

    return prepare


def nodegraph_stored(folder: Path, *, requested: bool) -> Engine:
    """Return the engine that keeps its results in a folder; the first run fills it.

    Its run returns the last value if it is asked for, else nothing: then nothing is read again.
    """

    def prepare(work: Work, count: int) -> Build:
        registry, last = registry_of(work), f"n{count}"
        planned = plan(
            build_graph(read_graph_text(chain_text(count), "chain.yaml", HERE), registry)
        )

        def build() -> Run:
            def run() -> object:
                store = open_store(registry, folder, _fail)
                done = execute(planned, how=HowToRun("serial"), store=store)
                return done[last].value if requested else None

            return run

        return build

    return prepare


def _fail(text: str) -> None:
    raise AssertionError(text)
