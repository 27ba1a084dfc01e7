"""``nodegraph audit``."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from nodegraph.cli.common import completed, graph_of, say, store_of
from nodegraph.cli.progress import columns

if TYPE_CHECKING:
    from nodegraph.audit.audit import Audited
    from nodegraph.execute import Run

_HEADS = ("node", "method", "grade", "cases", "what")


def audit(arguments: Namespace) -> int:
    """Run a graph, repeat its steps, and print for each method whether it gives one answer."""
    from nodegraph.audit.audit import GOOD, audit, cases

    graph = graph_of(arguments)
    store = store_of(arguments, graph)
    run = completed(arguments, graph, store)
    chosen = cases(run, every=arguments.all)
    wanted = {index for steps in chosen.values() for index in steps}
    say(f"repeating {len(wanted)} of {len(run.plan.steps)} steps")
    found = {one.step.index: one for one in audit(run, wanted)}
    print(columns([_HEADS, *_rows(run, chosen, found)]))
    for line in (*_told(found.values(), writable=store.writable), *run.not_stored()):
        print(f"\n{line}")
    return 0 if all(one.grade in GOOD for one in found.values()) else 1


def _rows(
    run: Run,
    chosen: Mapping[tuple[str, str], tuple[int, ...]],
    found: Mapping[int, Audited],
) -> Iterator[tuple[str, ...]]:
    """Yield a row per node and method, which tells the worst of its steps."""
    from nodegraph.audit.audit import WORSE

    for (node, label), steps in chosen.items():
        method = run.plan.graph.nodes[node].methods[label].node.name
        worst = max((found[index] for index in steps), key=lambda one: WORSE.index(one.grade))
        count = sum(found[index].grade == worst.grade for index in steps)
        cases = f"{count} of {len(steps)}" if count < len(steps) else str(len(steps))
        yield node, method, worst.grade, cases, worst.text


def _told(found: Iterable[Audited], *, writable: bool) -> Iterator[str]:
    """Yield what follows for later runs."""
    several = {one.step.method.node.name for one in found if one.is_one_of_several}
    names = ", ".join(sorted(several))
    if several and writable:
        yield (
            f"{names}: results are not stored any more, nor what is made of them, and runs say so; "
            "that ends when the code is edited, or with `nodegraph cache clear`"
        )
    elif several:
        yield f"{names}: later runs will not know, because the store cannot be written"
