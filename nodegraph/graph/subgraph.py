"""A graph file that was checked by itself: what it asks for, what it gives, what lies between."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from nodegraph.errors import Problems
from nodegraph.graph.flat import Flat
from nodegraph.graph.model import Gather, Graph, sources_of
from nodegraph.graph.named import columns_of
from nodegraph.ports import Port
from nodegraph.registry import Registered
from nodegraph.spec.parts import GraphSpec, Reference


@dataclass(frozen=True)
class Subgraph:
    """A graph file as whoever uses it sees it.

    Attributes
    ----------
    spec : GraphSpec
        Flat, and only what leads to its outputs: what is put in the place of a node.
    graphs : mapping of node to (mapping of label to Registered)
        What stands in it for the graphs that its own nodes use.
    asks : mapping of name to Port
        Its inputs that are ports. One takes the truth if everything that reads it does, and
        gathers if everything that reads it does.
    outputs : mapping of name to Port
    is_whole : bool
        Whether no mistake was found in it; else nothing is known of its outputs.
    """

    spec: GraphSpec
    graphs: Mapping[str, Mapping[str, Registered]]
    asks: Mapping[str, Port]
    outputs: Mapping[str, Port]
    is_whole: bool


def broken(flat: Flat) -> Subgraph:
    """Return what is known of a graph in which there are mistakes."""
    asks = {name: replace(one, truth=True, across=True) for name, one in flat.ports.items()}
    return Subgraph(_with_settings_only(flat, flat.spec), {}, asks, {}, is_whole=False)


def subgraph_of(flat: Flat, graph: Graph, problems: Problems) -> Subgraph:
    """Return what whoever uses a graph has to know; note what keeps it from being used."""
    asks = {name: _asked(port, graph) for name, port in flat.ports.items()}
    outputs = {
        name: _output(name, source, graph, asks, problems)
        for name, source in flat.spec.outputs.items()
    }
    for known in flat.spec.known:
        if known.node.startswith("$"):
            message = f"known: {known} comes from outside; only the graph that gives it can say so"
            problems.add(known.place, message)
    kept = _leading_to(flat.spec.outputs, graph)
    nodes = {name: one for name, one in flat.spec.nodes.items() if name in kept}
    axes = {
        name for one in kept for m in graph.nodes[one].methods.values() for name in m.settings.axes
    }
    spec = replace(
        _with_settings_only(flat, flat.spec),
        nodes=nodes,
        axes={name: one for name, one in flat.spec.axes.items() if name in axes},
        skip=tuple(
            item
            for item in flat.spec.skip
            if any(item.labels.keys() <= set(graph.nodes[one].axes) for one in kept)
        ),
        known=tuple(one for one in flat.spec.known if one.node in kept),
    )
    graphs = {name: one for name, one in flat.graphs.items() if name in kept}
    return Subgraph(spec, graphs, asks, outputs, is_whole=not problems)


def _with_settings_only(flat: Flat, spec: GraphSpec) -> GraphSpec:
    inputs = {name: one for name, one in spec.inputs.items() if name not in flat.ports}
    return replace(spec, inputs=inputs)


def _asked(port: Port, graph: Graph) -> Port:
    readers = list(_readers(f"${port.name}", graph))
    return replace(
        port,
        truth=bool(readers) and all(one.truth for one, _ in readers),
        across=bool(readers) and all(alone and one.across for one, alone in readers),
    )


def _readers(name: str, graph: Graph) -> Iterator[tuple[Port, bool]]:
    """Yield the ports that a node feeds, and whether it is all that feeds them."""
    for node in graph.nodes.values():
        for method in node.methods.values():
            for port, fed in method.inputs.items():
                found = method.node.port(port)
                if found is not None and name in {one.node for one in sources_of(fed)}:
                    yield found, not (isinstance(fed, Gather) and fed.axis)


def _output(
    name: str,
    source: Reference,
    graph: Graph,
    asks: Mapping[str, Port],
    problems: Problems,
) -> Port:
    """Return an output as a port, of the type that fits whatever comes out there."""
    if source.node.startswith("$"):
        return replace(asks[source.node[1:]], name=name, across=False)
    if name in graph.nodes and not _is_node_itself(name, source, graph):
        message = f"output {name!r} is not the node of that name"
        problems.add(source.place, message, "outside, both would have one name; rename the output")
    methods = graph.nodes[source.node].methods.values()
    found = [(one.node, one.node.output(source.port) or one.node.outputs[0]) for one in methods]
    ports = [port for _, port in found]
    widest = [one for one in ports if all(issubclass(other.type, one.type) for other in ports)]
    if not widest:
        types = ", ".join(f"{port.type.__name__} ({node.name})" for node, port in found)
        problems.add(source.place, f"output {name!r} has no one type: {types}")
    kind = (widest or ports)[0].type
    return Port(name, kind, truth=any(one.truth for one in ports), columns=columns_of(ports))


def _is_node_itself(name: str, source: Reference, graph: Graph) -> bool:
    if source.node != name or source.at:
        return False
    methods = graph.nodes[name].methods.values()
    return all(one.node.outputs[0].name == source.port for one in methods) or not source.port


def _leading_to(outputs: Mapping[str, Reference], graph: Graph) -> set[str]:
    """Return the nodes that lead to outputs, without what stands for ports."""
    found: set[str] = set()
    pending = [source.node for source in outputs.values()]
    while pending:
        name = pending.pop()
        if name not in found and not name.startswith("$"):
            found.add(name)
            methods = graph.nodes[name].methods.values()
            feeds = (fed for one in methods for fed in one.inputs.values())
            pending.extend(source.node for fed in feeds for source in sources_of(fed))
    return found
