"""``nodegraph why``: explain why the steps of a node are not cached."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_graph, add_store
from nodegraph.errors import NodegraphError, listed, nearest

if TYPE_CHECKING:
    from nodegraph.runs.why import Explanation

HELP = "Explain why the steps of a node are not cached."

_MOST_STEPS = 3


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    parser.add_argument("node", metavar="NODE", help="Node of the graph.")
    parser.add_argument(
        "--run",
        type=Path,
        metavar="DIR",
        help="Earlier run to compare with (default: runs/GRAPH).",
    )
    add_store(parser)


def why(arguments: Namespace) -> int:
    """Print which part of the key of each step changed since an earlier run."""
    from nodegraph.cli.graphs import graph_of, run_folder, store_of
    from nodegraph.execute import StepCache
    from nodegraph.plan import plan
    from nodegraph.runs.saved_run import SavedRun
    from nodegraph.runs.why import Why

    graph = graph_of(arguments)
    if arguments.node not in graph.nodes:
        raise NodegraphError(
            f"the graph has no node {arguments.node!r}; {nearest(arguments.node, graph.nodes)}"
        )
    folder = arguments.run or run_folder(arguments)
    record = SavedRun(folder).record
    planned = plan(graph)
    cache = StepCache(planned, store_of(arguments, graph))
    steps = list(Why(planned, cache, record).explain(arguments.node))
    stored = sum(step.stored for step in steps)
    print(f"{arguments.node}: {stored} of {len(steps)} steps are stored; compared with {folder}")
    for reason, names in _by_reason(steps).items():
        print(f"\n{listed(names, _MOST_STEPS)}\n{reason}")
    return 0


def _by_reason(steps: list[Explanation]) -> dict[str, list[str]]:
    """Return the names of steps by what is printed of them."""
    names: dict[str, list[str]] = defaultdict(list)
    for step in steps:
        if step.changes or not step.stored:
            lines = [*step.changes, *(["stored under its new key"] if step.stored else [])]
            names["\n".join(f"    {line}" for line in lines)].append(step.step.name)
    return names
