"""Notices of nodes that mix samples over frames before others of these samples are hidden.

A node that looks ahead puts a part of each sample into those around it. Where samples are hidden
afterwards, those that stay show in part what they were, and methods look better than they are.
"""

from __future__ import annotations

from collections.abc import Iterator

import networkx as nx

from nodegraph.errors import Problem
from nodegraph.graph.model import Graph, GraphNode, Method
from nodegraph.node.declaration import UNDECLARED
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port


def mixing_notices(graph: Graph) -> Iterator[Problem]:
    """Yield a notice for each method that looks ahead upstream of a node that hides samples.

    A node hides samples if it damages what it takes and says which samples it has damaged:
    beside a first output of the type of its first port it has one of another type. Upstream,
    methods count that take and give that type and declare a look-ahead of more than 0 frames for
    any of their settings. Methods that declare none are not judged.
    """
    for node in graph.nodes.values():
        hiding = (_hidden_from(method.node) for method in node.methods.values())
        ports = [port for port in hiding if port is not None]
        if not ports:
            continue
        feeds = {
            source
            for source, target, wire in graph.wires()
            if target == node.name and wire.port == ports[0].name
        }
        upstream = feeds.union(*(nx.ancestors(graph.network, source) for source in feeds))
        for name in (name for name in graph.nodes if name in upstream):
            for method in graph.nodes[name].methods.values():
                if frames := _lookahead(method, ports[0].type):
                    yield _notice(graph.nodes[name], method, frames, node)


def _hidden_from(node: Node) -> Port | None:
    """Return the port of whose samples a node hides some, if it does."""
    port = next((port for port in node.inputs if not port.truth), None)
    if port is None or not node.damages or not issubclass(node.outputs[0].type, port.type):
        return None
    return port if any(output.type is not port.type for output in node.outputs) else None


def _lookahead(method: Method, kind: type) -> str:
    """Return how far a method from one type to itself looks ahead; empty if it does not."""
    takes = any(issubclass(port.type, kind) for port in method.node.inputs)
    gives = any(issubclass(port.type, kind) for port in method.node.outputs)
    if not (takes and gives):
        return ""
    frames = [method.node.lookahead(settings) for settings in method.settings.values.values()]
    if None in frames:
        return "over the whole take"
    most = max((number for number in frames if number is not UNDECLARED and number), default=0)
    return f"by {most} frame{'s' if most > 1 else ''}" if most else ""


def _notice(node: GraphNode, method: Method, frames: str, hiding: GraphNode) -> Problem:
    return Problem(
        method.place,
        f"{node.name} ({method.node.name}) looks ahead {frames}, and {hiding.name} hides samples "
        "afterwards: those that stay show in part what is hidden, so that errors are too small",
        f"feed {hiding.name} from what {node.name} reads, and compute {node.name} afterwards",
    )
