"""``nodegraph check``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Container

from nodegraph.cli.common import graph_of, left_out_lines, store_of
from nodegraph.cli.progress import columns
from nodegraph.graph import Graph
from nodegraph.plan import Plan


def check(arguments: Namespace) -> int:
    """Print what a graph would do, and how much of it is stored already."""
    from nodegraph.execute import StepCache
    from nodegraph.plan import plan

    graph = graph_of(arguments)
    made = plan(graph)
    cache = StepCache(made, store_of(arguments, graph))
    stored = {step.index for step in made.steps if step.index in cache}
    print(f"{graph.title}\n\n{columns(_rows(graph, made, stored))}\n")
    print(f"{len(made.steps)} steps, {len(stored)} of them stored")
    for line in left_out_lines(graph):
        print(line)
    skipped = sum(len(cells) for cells in made.skipped.values())
    if skipped:
        print(f"{skipped} combinations are skipped")
    return 0


def _rows(graph: Graph, made: Plan, stored: Container[int]) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = [("node", "uses", "along", "steps", "stored")]
    for node in graph.nodes.values():
        uses = ", ".join(method.node.name for method in node.methods.values())
        along = " x ".join(f"{axis} ({len(graph.axes[axis].labels)})" for axis in node.axes)
        steps = set(made.cells[node.name].values())
        there = sum(step in stored for step in steps)
        rows.append((node.name, uses, along, str(len(steps)), str(there)))
    return rows
