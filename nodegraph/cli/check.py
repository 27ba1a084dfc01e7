"""``nodegraph check``: validate a graph and show its plan."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Container, Iterator
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_graph, add_store
from nodegraph.cli.output import columns
from nodegraph.errors import listed

if TYPE_CHECKING:
    from nodegraph.plan import Plan

_MOST_USES = 4
HELP = "Validate a graph and show its plan."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    add_store(parser)


def check(arguments: Namespace) -> int:
    """Print the steps of a graph, and how many of them are stored."""
    from nodegraph.cli.graphs import graph_of, left_out_lines, store_of
    from nodegraph.execute import StepCache
    from nodegraph.plan import plan

    graph = graph_of(arguments)
    planned = plan(graph)
    cache = StepCache(planned, store_of(arguments, graph))
    stored = {step.index for step in planned.steps if step.index in cache}
    print(f"{graph.title}\n\n{columns(list(_rows(planned, stored)))}\n")
    print(f"{len(planned.steps)} steps, {len(stored)} of them stored")
    for line in left_out_lines(graph):
        print(line)
    skipped = sum(len(cells) for cells in planned.skipped.values())
    if skipped:
        print(f"{skipped} combinations are skipped")
    return 0


def _rows(plan: Plan, stored: Container[int]) -> Iterator[tuple[str, ...]]:
    yield "node", "uses", "along", "steps", "stored"
    for node in plan.graph.nodes.values():
        uses = listed((method.node.name for method in node.methods.values()), _MOST_USES)
        along = " x ".join(f"{axis} ({len(plan.graph.axes[axis].labels)})" for axis in node.axes)
        steps = set(plan.cells[node.name].values())
        yield node.name, uses, along, str(len(steps)), str(sum(step in stored for step in steps))
