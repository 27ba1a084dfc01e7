"""``nodegraph audit``: test whether methods give the same result again."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_executor, add_graph, add_store
from nodegraph.cli.output import columns, say

if TYPE_CHECKING:
    from nodegraph.audit.audit import Audited
    from nodegraph.execute import Run

HELP = "Test whether each method of a graph gives the same result again."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.description = (
        f"{HELP} Steps are repeated, also with more threads and in another process. "
        "The exit status is 1 if a method gives different results."
    )
    add_graph(parser)
    parser.add_argument(
        "--all", action="store_true", help="Repeat every combination, not one of each method."
    )
    add_executor(parser, default="processes")  # a node that ends its process ends nothing else
    add_store(parser)


def audit(arguments: Namespace) -> int:
    """Run a graph, repeat its steps, and print for each method whether results are the same."""
    from nodegraph.audit.audit import audit, cases
    from nodegraph.cli.graphs import graph_of, run_of, store_of

    graph = graph_of(arguments)
    store = store_of(arguments, graph)
    run = run_of(arguments, graph, store=store)
    by_method = cases(run, every=arguments.all)
    indices = {index for steps in by_method.values() for index in steps}
    say(f"repeating {len(indices)} of {len(run.plan.steps)} steps")
    audited = {result.step.index: result for result in audit(run, indices)}
    print(columns(list(_rows(run, by_method, audited))))
    for line in (*_notes(audited.values(), writable=store.writable), *run.not_stored()):
        print(f"\n{line}")
    run.tidy()
    return 0 if all(result.grade.passes for result in audited.values()) else 1


def _rows(
    run: Run,
    by_method: Mapping[tuple[str, str], tuple[int, ...]],
    audited: Mapping[int, Audited],
) -> Iterator[tuple[str, ...]]:
    """Yield a row per node and method, with the worst of its steps."""
    yield "node", "method", "grade", "cases", "what"
    for (node, label), steps in by_method.items():
        method = run.plan.graph.nodes[node].methods[label].node.name
        worst = max((audited[index] for index in steps), key=lambda result: result.grade.rank)
        count = sum(audited[index].grade == worst.grade for index in steps)
        cases = f"{count} of {len(steps)}" if count < len(steps) else str(len(steps))
        yield node, method, worst.grade, cases, worst.text


def _notes(audited: Iterable[Audited], *, writable: bool) -> Iterator[str]:
    """Yield the consequences for later runs."""
    several = {result.step.method.node.name for result in audited if result.varies}
    names = ", ".join(sorted(several))
    if several and writable:
        yield (
            f"{names}: results are no longer stored, nor results made from them, and runs say so, "
            "until the code is edited or `nodegraph cache clear` is run"
        )
    elif several:
        yield f"{names}: later runs will not know, because the store cannot be written"
