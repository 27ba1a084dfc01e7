"""``nodegraph why``."""

from __future__ import annotations

from argparse import Namespace
from collections import defaultdict

from nodegraph.cli.common import graph_of, run_folder, store_of
from nodegraph.errors import NodegraphError, listed, nearest
from nodegraph.execute.step_cache import StepCache
from nodegraph.plan import plan
from nodegraph.runs.saved_run import FinishedRun
from nodegraph.runs.why import Explained, Why

_MOST_STEPS = 3


def why(arguments: Namespace) -> int:
    """Print why the steps of a node would run again, or that they would not."""
    graph = graph_of(arguments)
    if arguments.node not in graph.nodes:
        raise NodegraphError(
            f"the graph has no node {arguments.node!r}; {nearest(arguments.node, graph.nodes)}"
        )
    folder = arguments.run or run_folder(arguments)
    record = FinishedRun(folder).record
    made = plan(graph)
    cache = StepCache(made, store_of(arguments, graph))
    found = list(Why(made, cache, record).explain(arguments.node))
    stored = sum(one.stored for one in found)
    print(f"{arguments.node}: {stored} of {len(found)} steps are stored; compared with {folder}")
    for reason, steps in _by_reason(found).items():
        print(f"\n{listed((one.step.name for one in steps), _MOST_STEPS)}\n{reason}")
    return 0


def _by_reason(found: list[Explained]) -> dict[str, list[Explained]]:
    grouped: dict[str, list[Explained]] = defaultdict(list)
    for one in found:
        if one.stored and not one.changes:
            continue
        state = ["    stored under its new key"] if one.stored else []
        grouped["\n".join([f"    {change}" for change in one.changes] + state)].append(one)
    return grouped
