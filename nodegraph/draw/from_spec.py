"""A graph file that is not valid as a picture, as far as it can be read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from nodegraph.draw.from_graph import socket_of
from nodegraph.draw.picture import Alternative, Arrow, Box, Picture, Socket
from nodegraph.errors import Problems
from nodegraph.graph.used_graphs import UsedGraphs
from nodegraph.graphfile.spec import GraphSpec, NodeSpec, Reference
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registry


def picture_of_spec(spec: GraphSpec, registry: Registry) -> Picture:
    """Return the picture of a spec: its nodes, and the arrows between nodes that are there.

    Every port is drawn. Axes and what an arrow carries only a valid graph has.
    """
    graphs = UsedGraphs(spec.graphs, registry, Problems()).nodes(spec)
    used = {name: _installed(node, registry, graphs) for name, node in spec.nodes.items()}
    arrows: dict[Arrow, None] = {}
    for name, node in spec.nodes.items():
        for port, reference in _feeds(node):
            if reference.node in used:
                arrows[_arrow(used, name, port, reference)] = None
    boxes = []
    for name, node in spec.nodes.items():
        fed = [arrow.target_port for arrow in arrows if arrow.target == name]
        read = [arrow.source_port for arrow in arrows if arrow.source == name]
        boxes.append(_box(spec, node, used[name], fed, read))
    return Picture(spec.title or spec.file, tuple(boxes), tuple(arrows))


def _installed(node: NodeSpec, registry: Registry, graphs: Mapping[str, Node]) -> Node | None:
    """Return the first of a node's methods that is installed, or a graph file."""
    for method in node.methods:
        if method.use in graphs:
            return graphs[method.use]
        if used := registry.used(method.use):
            return used[0].node
    return None


def _feeds(node: NodeSpec) -> Iterator[tuple[str, Reference]]:
    """Yield each port that is fed, as it is written, and what feeds it."""
    for wiring in (node.wiring, *(method.wiring for method in node.methods)):
        for port, feed in wiring.items():
            sources = [feed] if isinstance(feed, Reference) else feed.sources.values()
            yield from ((port, source) for source in sources)


def _arrow(used: dict[str, Node | None], name: str, port: str, source: Reference) -> Arrow:
    target, origin = used[name], used[source.node]
    first_input = target.inputs[0].name if target and target.inputs else "input"
    outputs = origin.outputs if origin else ()
    output = source.port or (outputs[0].name if outputs else "output")
    known = origin.output(output) if origin else None
    truth = known is not None and known.truth
    return Arrow(source.node, output, name, port or first_input, truth=truth)


def _box(
    spec: GraphSpec, node: NodeSpec, used: Node | None, fed: list[str], read: list[str]
) -> Box:
    inputs = {port.name: socket_of(port) for port in used.inputs} if used else {}
    outputs = {port.name: socket_of(port) for port in used.outputs} if used else {}
    inputs |= {name: Socket(name) for name in fed if name not in inputs}
    outputs |= {name: Socket(name) for name in read if name not in outputs}
    uses = tuple(method.label or method.use for method in node.methods)
    is_reported = any(entry.node == node.name for entry in spec.report)
    return Box(
        node.name,
        lines=() if node.has_alternatives else uses,
        inputs=tuple(inputs.values()),
        outputs=tuple(outputs.values()),
        alternatives=tuple(map(Alternative, uses)) if node.has_alternatives else (),
        compares=node.has_alternatives,
        kind="report" if is_reported else "node" if inputs else "input",
    )
