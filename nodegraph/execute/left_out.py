"""What a command has left out of a graph: each node once, with all its reasons."""

from __future__ import annotations

from nodegraph.graph import Graph


def left_out(graph: Graph) -> dict[str, str]:
    """Return why nodes are left out, by node."""
    reasons: dict[str, dict[str, None]] = {}
    for one in graph.left_out:
        reasons.setdefault(one.node, {})[one.reason] = None
    return {node: "; ".join(found) for node, found in reasons.items()}


def left_out_together(graph: Graph) -> dict[str, tuple[str, ...]]:
    """Return which nodes are left out, by the reason that they have in common."""
    together: dict[str, tuple[str, ...]] = {}
    for node, reason in left_out(graph).items():
        together[reason] = (*together.get(reason, ()), node)
    return together


def left_out_lines(graph: Graph) -> list[str]:
    """Return what a terminal says of it: ``left out: faces, playback: why``."""
    return [
        f"left out: {', '.join(nodes)}: {reason}"
        for reason, nodes in left_out_together(graph).items()
    ]
