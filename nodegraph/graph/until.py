"""A graph cut short: some of its nodes, with what feeds them, and nothing else."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from nodegraph.errors import NodegraphError, nearest
from nodegraph.graph.model import Graph, sources_of
from nodegraph.spec.parts import Reference


def until(graph: Graph, names: Iterable[str]) -> Graph:
    """Return the graph with these nodes and all that they need; these are what it reports.

    Raises
    ------
    NodegraphError
        If the graph lacks one of them.
    """
    asked = tuple(dict.fromkeys(names))
    for name in asked:
        if name not in graph.nodes:
            raise NodegraphError(f"the graph has no node {name!r}; {nearest(name, graph.nodes)}")
    kept = set(asked)
    for name in reversed(list(graph.nodes)):
        if name in kept:
            methods = graph.nodes[name].methods.values()
            feeds = (fed for method in methods for fed in method.inputs.values())
            kept.update(source.node for fed in feeds for source in sources_of(fed))
    report = tuple(Reference(name, "", graph.nodes[name].place) for name in asked)
    nodes = {name: node for name, node in graph.nodes.items() if name in kept}
    return replace(graph, nodes=nodes, spec=replace(graph.spec, report=report))
