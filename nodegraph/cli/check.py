"""``nodegraph check``: validate a graph and show its plan."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_graph, add_json, add_store
from nodegraph.cli.live import add_hold, lines_on
from nodegraph.cli.output import columns
from nodegraph.cli.why import why
from nodegraph.errors import Problems, listed
from nodegraph.formatting import number_of

if TYPE_CHECKING:
    from nodegraph.cli.answers import PlannedNode
    from nodegraph.graph import Graph
    from nodegraph.live.plan import LivePlan
    from nodegraph.plan import Plan

_MOST_USES = 4
_HEAD = ("node", "uses", "along", "steps", "stored")
HELP = "Validate a graph, with the files that can be read at once, and show its plan."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    add_store(parser)
    parser.add_argument(
        "--why",
        metavar="NODE",
        help="Explain instead why the steps of a node are not stored, or were computed again.",
    )
    parser.add_argument(
        "--run",
        type=Path,
        metavar="DIR",
        help="With --why: earlier run to compare with (default: runs/GRAPH).",
    )
    parser.add_argument(
        "--live",
        nargs="?",
        type=float,
        const=0.0,
        metavar="HZ",
        help="Show instead the part of the graph that runs on a stream, and its delay in frames, "
        "also in ms if the rate of the stream is given.",
    )
    parser.add_argument(
        "--source", default="", metavar="NAME", help="With --live: what the stream replaces."
    )
    add_hold(parser)
    add_json(parser)


def check(arguments: Namespace) -> int:
    """Print the steps of a graph, and how many of them are stored."""
    from nodegraph.cli.answers import CheckAnswer, print_json
    from nodegraph.cli.graphs import graph_of, left_out_lines, store_of
    from nodegraph.execute.preflight import check_files_and_settings
    from nodegraph.execute.resume import StoredSteps
    from nodegraph.plan import plan

    graph = graph_of(arguments)
    if arguments.why:
        why(graph, arguments)
        return 0
    if arguments.live is not None:
        return _check_live(graph, arguments)
    planned = plan(graph)
    cache = StoredSteps(planned, store_of(arguments, graph))
    stored = {step.index for step in planned.steps if step.index in cache}
    problems = Problems()
    warnings = check_files_and_settings(planned, cache, problems)
    problems.raise_any()
    skipped = sum(len(cells) for cells in planned.skipped.values())
    nodes, left_out = list(_nodes(planned, stored)), left_out_lines(graph)
    answer = CheckAnswer(
        graph.title, len(planned.steps), len(stored), skipped, nodes, left_out, warnings
    )
    if arguments.json:
        print_json(answer)
        return 0
    print(f"{answer.title}\n\n{columns([_HEAD, *map(_row, nodes)])}\n")
    print(f"{number_of(answer.steps, 'step')}, {answer.stored:,} of them stored")
    for line in left_out:
        print(line)
    if skipped:
        print(f"{number_of(skipped, 'combination')} skipped")
    for warning in warnings:
        print(f"warning: {warning}")
    return 0


def _nodes(plan: Plan, stored: Collection[int]) -> Iterator[PlannedNode]:
    from nodegraph.cli.answers import PlannedNode

    for node in plan.graph.nodes.values():
        uses = [method.node.name for method in node.methods.values()]
        axes = {axis: plan.graph.axes[axis].labels for axis in node.axes}
        steps = set(plan.cells[node.name].values())
        yield PlannedNode(node.name, uses, axes, len(steps), len(steps.intersection(stored)))


def _row(node: PlannedNode) -> tuple[str, ...]:
    along = " x ".join(f"{axis} ({len(labels)})" for axis, labels in node.axes.items())
    return node.node, listed(node.uses, _MOST_USES), along, str(node.steps), str(node.stored)


def _check_live(graph: Graph, arguments: Namespace) -> int:
    """Print each way through the part of a graph that runs on a stream."""
    from nodegraph.live.plan import live_plan

    planned = live_plan(graph, arguments.source, hold=arguments.hold)
    source = planned.plan.steps[planned.source.step]
    outputs = source.method.node.outputs
    port = f".{outputs[planned.source.position].name}" if len(outputs) > 1 else ""
    print(f"{graph.title}\n\nstream in place of {source.node}{port}\n")
    print(columns(list(_paths(planned, arguments.live))))
    if held := dict.fromkeys(step.node for step in planned.held):
        print(f"\ncomputed once: {', '.join(held)}")
    for line in lines_on(planned):
        print(line)
    return 0


def _paths(planned: LivePlan, rate: float) -> Iterator[tuple[str, ...]]:
    yield "path", "frames behind", *(["ms"] if rate else []), "most of it"
    for path in planned.paths():
        frames = path[-1].behind
        slowest = max(path, key=lambda live: live.lookahead)
        name = f"{slowest.step.name} ({slowest.lookahead})" if frames else ""
        steps = " > ".join(live.step.node for live in path[:-1])
        whole = f"{steps} > {path[-1].step.name}" if steps else path[-1].step.name
        yield whole, str(frames), *([f"{1000 * frames / rate:.1f}"] if rate else []), name
