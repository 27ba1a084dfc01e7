"""Explains why the steps of a node are not stored, for ``nodegraph check --why``."""

from __future__ import annotations

from argparse import Namespace
from collections import defaultdict
from collections.abc import Iterator
from typing import TYPE_CHECKING

from nodegraph.cli.output import few
from nodegraph.errors import NodegraphError, listed, nearest

if TYPE_CHECKING:
    from nodegraph.graph import Graph
    from nodegraph.runs.why import Explanation

_MOST_STEPS = 3


def why(graph: Graph, arguments: Namespace) -> None:
    """Print which part of the key of each step of a node changed since an earlier run."""
    from nodegraph.cli.answers import ExplainedStep, WhyAnswer, print_json
    from nodegraph.cli.graphs import run_folder, store_of
    from nodegraph.execute.resume import StoredSteps
    from nodegraph.plan import plan
    from nodegraph.runs.record_files import read_record
    from nodegraph.runs.why import Why

    node: str = arguments.why
    if node not in graph.nodes:
        raise NodegraphError(f"the graph has no node {node!r}; {nearest(node, graph.nodes)}")
    folder = arguments.run or run_folder(arguments)
    record = read_record(folder)
    planned = plan(graph)
    cache = StoredSteps(planned, store_of(arguments, graph))
    steps = list(Why(planned, cache, record).explain(node))
    if arguments.json:
        explained = [
            ExplainedStep(each.step.node, each.step.labels, each.stored, each.changes)
            for each in steps
        ]
        print_json(WhyAnswer(node, str(folder), explained))
        return
    stored = sum(step.stored for step in steps)
    print(f"{node}: {stored} of {len(steps)} steps are stored; compared with {folder}")
    for names, lines in _by_reason(steps):
        print("\n".join(["", listed(names, _MOST_STEPS), *(f"    {line}" for line in few(lines))]))


def _by_reason(steps: list[Explanation]) -> Iterator[tuple[list[str], list[str]]]:
    """Yield the names of steps, and what is printed of them.

    Changes that are the same at several combinations of a node are one line.
    """
    from nodegraph.runs.why import node_and_text, together

    groups: dict[tuple[object, ...], list[Explanation]] = defaultdict(list)
    for step in steps:
        if step.changes or not step.stored:
            changes = dict.fromkeys(node_and_text(line)[::2] for line in step.changes)
            groups[(step.stored, *changes)].append(step)
    for same in groups.values():
        lines = together(same) + ["stored under its new key"] * same[0].stored
        yield [step.step.name for step in same], lines
