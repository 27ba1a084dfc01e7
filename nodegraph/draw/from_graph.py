"""A checked graph as a picture: only ports that are wired are drawn."""

from __future__ import annotations

from collections.abc import Sequence

from nodegraph.draw.picture import Arrow, Box, Kind, Picture, Socket
from nodegraph.draw.shape import shortened
from nodegraph.draw.svg import svg
from nodegraph.formatting import labels_of
from nodegraph.graph import Graph, GraphNode
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Label, Port

_MOST_METHODS = 12
_MOST_ON_A_PAGE = 500
_LONGEST_LABEL = 16


def drawing_for_page(graph: Graph) -> str:
    """Return a graph as SVG for a page, or an empty string if it is too large for one.

    A drawing of thousands of nodes takes tens of megabytes and is unreadable.
    """
    return svg(picture_of(graph)) if len(graph.nodes) <= _MOST_ON_A_PAGE else ""


def picture_of(graph: Graph) -> Picture:
    """Return the picture of a graph."""
    arrows: dict[tuple[str, str, str, str], Arrow] = {}
    for source, target, wire in graph.wires():
        arrows.setdefault(
            (source, wire.output, target, wire.port),
            Arrow(
                source,
                wire.output,
                target,
                wire.port,
                gathers=wire.gathers,
                truth=_is_truth(graph.nodes[source], wire.output),
                fixed=labels_of(wire.reference.at),
            ),
        )
    read = {(source, output) for source, output, _, _ in arrows}
    fed = {(target, port) for _, _, target, port in arrows}
    boxes = tuple(_box(graph, node, read, fed) for node in graph.nodes.values())
    return Picture(graph.title, boxes, tuple(arrows.values()))


def labels_text(labels: Sequence[Label], longest: int = 24) -> str:
    """Return the labels of an axis if they are short, else their number, the first and the last."""
    short = [shortened(str(label), _LONGEST_LABEL) for label in labels]
    text = ", ".join(short)
    if len(text) <= longest or len(short) < 3:
        return text
    return f"{len(short)} labels: {short[0]} … {short[-1]}"


def _box(
    graph: Graph, node: GraphNode, read: set[tuple[str, str]], fed: set[tuple[str, str]]
) -> Box:
    described = node.first.node
    ports = {port.name: port for method in node.methods.values() for port in method.node.inputs}
    inputs = [_socket(port) for port in ports.values() if (node.name, port.name) in fed]
    outputs = [_socket(port) for port in _outputs(described, node.name, read)]
    labels = list(node.methods) if node.has_alternatives else []
    more = [f"and {len(labels) - _MOST_METHODS} more"] if len(labels) > _MOST_METHODS else []
    return Box(
        node.name,
        lines=() if node.has_alternatives else (described.name,),
        inputs=tuple(inputs),
        outputs=tuple(outputs),
        alternatives=(*labels[:_MOST_METHODS], *more),
        axes=tuple(
            f"{axis}: {labels_text(graph.axes[axis].labels)}" for axis in _own_axes(graph, node)
        ),
        kind=_kind(graph, node),
    )


def _outputs(node: Node, name: str, read: set[tuple[str, str]]) -> list[Port]:
    wired = [port for port in node.outputs if (name, port.name) in read]
    return wired or list(node.outputs[:1])


def _own_axes(graph: Graph, node: GraphNode) -> tuple[str, ...]:
    """Return the axes that begin at this node: those that its settings name."""
    named = {axis for method in node.methods.values() for axis in method.settings.axes}
    return tuple(axis for axis in graph.axes if axis in named)


def _kind(graph: Graph, node: GraphNode) -> Kind:
    if any(entry.node == node.name for entry in graph.spec.report):
        return "report"
    return "node" if any(method.inputs for method in node.methods.values()) else "input"


def _socket(port: Port) -> Socket:
    return Socket(port.name, str(port).partition(": ")[2])


def _is_truth(node: GraphNode, output: str) -> bool:
    port = node.first.node.output(output)
    return port is not None and port.truth
