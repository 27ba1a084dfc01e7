"""``nodegraph check``."""

from __future__ import annotations

from argparse import Namespace

from nodegraph.commands.chosen import graph_of
from nodegraph.terminal import columns


def check(arguments: Namespace) -> int:
    """Print what a graph would do."""
    from nodegraph.plan import plan

    graph = graph_of(arguments)
    made = plan(graph)
    rows = [("node", "uses", "along", "steps")]
    counts = {name: len(set(cells.values())) for name, cells in made.cells.items()}
    for node in graph.nodes.values():
        uses = ", ".join(method.node.name for method in node.methods.values())
        along = " x ".join(f"{axis} ({len(graph.axes[axis].labels)})" for axis in node.axes)
        rows.append((node.name, uses, along, str(counts[node.name])))
    print(f"{graph.title}\n\n{columns(rows)}\n\n{len(made.steps)} steps")
    for one in graph.left_out:
        print(f"left out: {one.node}: {one.reason}")
    skipped = sum(len(cells) for cells in made.skipped.values())
    if skipped:
        print(f"{skipped} combinations are skipped")
    return 0
