"""The leak check: no method may see the truth that it is scored against.

Let a node Q have a required truth port that is fed, at any distance, by a node H that hides
samples (it has a truth output). What lies upstream of H, and H's truth outputs, must not reach
a plain port of Q by a way that does not pass H's plain outputs. The same file read twice is the
same source. Ports that only draw, which are optional, are exempt, and no way leads through what
the graph declares as known. A pass-through node is neither H nor Q: its outputs come from where
its inputs come from.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import networkx as nx

from nodegraph.errors import Place, Problems
from nodegraph.graph.model import Graph, GraphNode, Method, sources_of
from nodegraph.graph.pass_through import PassThrough
from nodegraph.node.ports import Port


def check_leaks(graph: Graph, problems: Problems) -> None:
    """Record every wire by which the truth reaches a node that is scored against it."""
    hiding = {name: _truth_outputs(node) for name, node in graph.nodes.items()}
    hiding = {name: outputs for name, outputs in hiding.items() if outputs}
    if not hiding:
        return
    flows = _flows(graph)
    network = _network(graph, flows)
    unknown = _network(graph, (flow for flow in flows if not flow.is_known))
    for name, outputs in hiding.items():
        fed = nx.descendants(network, name) | {name}
        scored = [node for node in graph.nodes.values() if _is_scored(node, fed, network)]
        if scored:
            truth = _Truth(name, outputs, unknown)
            for node in scored:
                truth.check(node, problems)


class _Flow(NamedTuple):
    """From an output of a node, or from a file, to a port of another node."""

    source: str
    output: str
    is_known: bool
    target: str
    port: str
    place: Place

    def __str__(self) -> str:
        return f"{self.source}.{self.output}" if self.output else self.source


class _Origin(NamedTuple):
    """An output that is computed, and whether it is declared as known on the way from there."""

    node: str
    output: str
    is_known: bool


def _network(graph: Graph, flows: Iterable[_Flow]) -> nx.MultiDiGraph[str]:
    network: nx.MultiDiGraph[str] = nx.MultiDiGraph()
    network.add_nodes_from(graph.nodes)
    for flow in flows:
        network.add_edge(flow.source, flow.target, flow=flow)
    return network


def _flows_into(name: str, network: nx.MultiDiGraph[str]) -> Iterator[_Flow]:
    return (edge["flow"] for _, _, edge in network.in_edges(name, data=True))


def _flows(graph: Graph) -> list[_Flow]:
    """Return the wires between nodes that compute, past pass-through nodes, and the files read."""
    known = {(reference.node, reference.port) for reference in graph.spec.known}
    origins: dict[tuple[str, str], dict[_Origin, None]] = {}
    flows: dict[_Flow, None] = {}
    for node in graph.nodes.values():
        for output in {port.name for m in node.methods.values() for port in m.node.outputs}:
            is_known = not known.isdisjoint({(node.name, output), (node.name, "")})
            origins[node.name, output] = {
                origin._replace(is_known=origin.is_known or is_known): None
                for method in node.methods.values()
                for origin in _origins(graph, node, method, output, origins)
            }
        for method in _computing(node):
            for port, feed in method.inputs.items():
                for source in sources_of(feed):
                    for origin in origins[source.node, graph.output_name(source)]:
                        flows[_Flow(*origin, node.name, port, source.place)] = None
        for file in _files(node):
            flows[_Flow(f"file {file}", "", False, node.name, "", node.place)] = None
    return list(flows)


def _origins(
    graph: Graph,
    node: GraphNode,
    method: Method,
    output: str,
    origins: Mapping[tuple[str, str], Collection[_Origin]],
) -> Iterator[_Origin]:
    """Yield where an output of a method comes from: itself, or the outputs that it passes on."""
    if not isinstance(method.node, PassThrough):
        yield _Origin(node.name, output, False)
        return
    names = [port.name for port in method.node.outputs]
    # first outputs may differ in name among alternatives
    port = method.node.inputs[names.index(output) if output in names else 0].name
    for source in sources_of(method.inputs[port]):
        yield from origins[source.node, graph.output_name(source)]


class _Truth:
    """What a node hides, and the nodes that it reaches by ways around the node's plain outputs.

    Parameters
    ----------
    hiding
        The node.
    outputs
        Its truth outputs.
    network
        Without what is declared as known.
    """

    def __init__(
        self, hiding: str, outputs: Collection[str], network: nx.MultiDiGraph[str]
    ) -> None:
        self._hiding = hiding
        self._outputs = outputs
        self._network = network
        sources = nx.ancestors(network, hiding) | {hiding}
        # in wires, from what lies upstream or from a truth output
        self._distance = nx.multi_source_dijkstra_path_length(network, sources, weight=self._length)

    def check(self, node: GraphNode, problems: Problems) -> None:
        """Record the plain ports of a scored node that the truth reaches."""
        for flow in self._carriers(node.name):
            if not any(port.truth for port in _ports(node, flow.port)):
                problems.add(
                    flow.place,
                    f"{node.name} is scored against what {self._hiding} hides, and can see it: "
                    f"{self._path(flow)}",
                    f"feed it from {self._hiding}'s other outputs, "
                    "or declare under 'known' what a method may know",
                )

    def _length(self, source: str, target: str, edges: Mapping[Any, Any]) -> float | None:
        """Return None for edges that do not carry the truth: networkx ignores them."""
        if target == self._hiding:
            return None
        if source == self._hiding:
            outputs = {edge["flow"].output for edge in edges.values()}
            return None if outputs.isdisjoint(self._outputs) else 1
        return 1

    def _carriers(self, name: str) -> Iterator[_Flow]:
        """Yield the flows that carry the truth to a node."""
        for flow in _flows_into(name, self._network):
            if flow.source == self._hiding:
                if flow.output in self._outputs:
                    yield flow
            elif flow.source in self._distance:
                yield flow

    def _path(self, last: _Flow) -> str:
        """Return the shortest way of the truth that ends with a flow."""
        way = [last]
        while steps := self._distance[way[0].source]:
            before = self._carriers(way[0].source)
            way.insert(0, next(flow for flow in before if self._distance[flow.source] < steps))
        return " -> ".join([*map(str, way), f"{last.target}.{last.port}"])


def _is_scored(node: GraphNode, fed: Collection[str], network: nx.MultiDiGraph[str]) -> bool:
    """Whether a node is among these, and one of them feeds a required truth port of it."""
    return node.name in fed and any(
        flow.source in fed
        and any(port.truth and not port.optional for port in _ports(node, flow.port))
        for flow in _flows_into(node.name, network)
    )


def _computing(node: GraphNode) -> Iterator[Method]:
    """Yield the methods that are not pass-through nodes."""
    methods = node.methods.values()
    return (method for method in methods if not isinstance(method.node, PassThrough))


def _truth_outputs(node: GraphNode) -> set[str]:
    return {port.name for m in _computing(node) for port in m.node.outputs if port.truth}


def _ports(node: GraphNode, name: str) -> list[Port]:
    """Return the ports of that name that the methods of a node have."""
    ports = (method.node.port(name) for method in _computing(node))
    return [port for port in ports if port is not None]


def _files(node: GraphNode) -> set[str]:
    return {
        str(values[name])
        for method in node.methods.values()
        for values in method.settings.values.values()
        for name, setting in method.node.settings.items()
        if setting.is_file and values.get(name) is not None
    }
