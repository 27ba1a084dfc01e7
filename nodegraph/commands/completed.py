"""A run for what it comes to alone: no folder is written."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from nodegraph.commands.chosen import say
from nodegraph.terminal import progress

if TYPE_CHECKING:
    from nodegraph.execute import Run
    from nodegraph.graph import Graph
    from nodegraph.store import Store


def completed(arguments: Namespace, graph: Graph, store: Store) -> Run:
    """Run a graph as the command says, and show how far it is."""
    from nodegraph.api import reported
    from nodegraph.execute import HowToRun, execute
    from nodegraph.execute.left_out import left_out_lines
    from nodegraph.plan import plan

    how = HowToRun(arguments.executor, arguments.jobs, arguments.scheduler)
    for line in left_out_lines(graph):
        say(line)
    with progress() as shown:
        return execute(
            plan(graph), how=how, store=store, keep=reported(graph), listeners=[shown.hear]
        )
