"""The leak check: no method may see the truth that it is scored against.

Let a node Q have a required truth port, and let H be the first damaging node (it has a truth
output) on a way back from that port; farther ones are upstream of it and decide nothing. What
lies upstream of H, and H's truth outputs, must not reach the estimate of Q by a way that does
not pass H's plain outputs. The same file read twice is the same source. Ports that only draw,
which are optional, are exempt, and no way leads through what the graph declares as known. A
damaging node is not a Q, and a pass-through node is neither H nor Q: its outputs come from where
its inputs come from.

The estimate of Q is every plain port of the type of one of its truth ports, or of a type derived
from it or the reverse; where there is none, every plain port.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import networkx as nx

from nodegraph.errors import Place, Problems
from nodegraph.graph.model import Graph, GraphNode, Method, sources_of
from nodegraph.graph.pass_through import PassThrough
from nodegraph.graphfile.spec import Reference
from nodegraph.node.ports import Port


def check_leaks(graph: Graph, problems: Problems) -> None:
    """Record every wire by which the truth reaches a node that is scored against it.

    Entries of ``known`` that cannot change this are recorded as well.
    """
    damaging = {name for name, node in graph.nodes.items() if _truth_outputs(node)}
    if not damaging:
        return
    origins = _output_origins(graph)
    flows = _flows(graph, origins)
    network = _network(graph, flows)
    scored: dict[str, list[GraphNode]] = {}
    for node in graph.nodes.values():
        for name in _deciding(node, damaging, network):
            scored.setdefault(name, []).append(node)
    unknown = _network(graph, (flow for flow in flows if not flow.is_known))
    for name, nodes in scored.items():
        truth = _Truth(graph.nodes[name], graph.nodes, unknown)
        for node in nodes:
            truth.check(node, problems)
    if scored and not graph.left_out:
        _check_known(graph, [graph.nodes[name] for name in scored], origins, network, problems)


def _deciding(
    node: GraphNode, damaging: Collection[str], network: nx.MultiDiGraph[str]
) -> Iterator[str]:
    """Yield the first damaging node on each way back from the required truth ports of a node."""
    if node.name in damaging:
        return
    ways = [
        flow.source
        for flow in _flows_into(node.name, network)
        if any(port.truth and not port.optional for port in _ports(node, flow.port))
    ]
    passed: set[str] = set()
    while ways:
        source = ways.pop()
        if source in passed:
            continue
        passed.add(source)
        if source in damaging:
            yield source
        else:
            ways.extend(network.predecessors(source))


def _check_known(
    graph: Graph,
    damaging: Collection[GraphNode],
    origins: _Origins,
    network: nx.MultiDiGraph[str],
    problems: Problems,
) -> None:
    """Record entries of ``known`` from which the check follows no way.

    They come from the plain outputs of damaging nodes alone, or from a node without inputs and
    feed damaging nodes alone. What a node without inputs gives besides, such as a made face and
    its model, may be listed.
    """
    free = [_free_of(node, network) for node in damaging]
    entries: dict[Place, list[Reference]] = {}  # one, or one per output of a used graph
    for reference in graph.spec.known:
        if reference.place.file == graph.spec.file:  # a used graph loads wherever it is used
            entries.setdefault(reference.place, []).append(reference)
    for place, references in entries.items():
        named = {
            (origin.node, origin.output)
            for (node, output), several in origins.items()
            if any(node == known.node and known.port in ("", output) for known in references)
            for origin in several
        }
        names = " and ".join(sorted(node.name for node in damaging))
        reason = ""
        if not any(is_free(*output) for output in named for is_free in free):
            reason = f"comes from nothing but what {names} leaves to be seen"
        elif all(_is_hidden(*output, damaging, network) for output in named):
            reason = f"feeds nothing but {names}"
        if reason:
            message = f"known: {references[0]} {reason}, so that this changes nothing"
            problems.add(place, message, "leave it out")


def _is_hidden(
    name: str, output: str, damaging: Collection[GraphNode], network: nx.MultiDiGraph[str]
) -> bool:
    """Whether an output of a node without inputs feeds damaging nodes alone."""
    edges = network.out_edges(name, data=True)
    readers = {target for _, target, edge in edges if edge["flow"].output == output}
    hiding = {node.name for node in damaging}
    return bool(readers) and readers <= hiding and not network.in_degree(name)


def _free_of(node: GraphNode, network: nx.MultiDiGraph[str]) -> Callable[[str, str], bool]:
    """Return a function that says whether an output has a source besides a node's plain outputs."""
    has_inputs = any(method.inputs for method in node.methods.values())
    around = _around(node, network)
    roots = {node.name, *(name for name, degree in network.in_degree() if not degree)}
    reached = roots.union(*(nx.descendants(around, root) for root in roots))

    def is_free(name: str, output: str) -> bool:
        if name == node.name and has_inputs:
            return output in _truth_outputs(node)
        return name in reached

    return is_free


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


_Origins = Mapping[tuple[str, str], Collection[_Origin]]
"""Node and output -> the outputs that it comes from."""


def _network(graph: Graph, flows: Iterable[_Flow]) -> nx.MultiDiGraph[str]:
    network: nx.MultiDiGraph[str] = nx.MultiDiGraph()
    network.add_nodes_from(graph.nodes)
    for flow in flows:
        network.add_edge(flow.source, flow.target, flow=flow)
    return network


def _around(node: GraphNode, network: nx.MultiDiGraph[str]) -> nx.DiGraph[str]:
    """Return a network without the ways that lead into a node, or out of its plain outputs."""
    truths = _truth_outputs(node)
    around: nx.DiGraph[str] = nx.DiGraph()
    around.add_nodes_from(network)
    around.add_edges_from(
        (source, target)
        for source, target, edge in network.edges(data=True)
        if target != node.name and (source != node.name or edge["flow"].output in truths)
    )
    return around


def _flows_into(name: str, network: nx.MultiDiGraph[str]) -> Iterator[_Flow]:
    return (edge["flow"] for _, _, edge in network.in_edges(name, data=True))


def _output_origins(graph: Graph) -> _Origins:
    """Return where each output is computed, past pass-through nodes."""
    known = {(reference.node, reference.port) for reference in graph.spec.known}
    origins: dict[tuple[str, str], dict[_Origin, None]] = {}
    for node in graph.nodes.values():
        for output in {port.name for m in node.methods.values() for port in m.node.outputs}:
            is_known = not known.isdisjoint({(node.name, output), (node.name, "")})
            origins[node.name, output] = {
                origin._replace(is_known=origin.is_known or is_known): None
                for method in node.methods.values()
                for origin in _origins(graph, node, method, output, origins)
            }
    return origins


def _flows(graph: Graph, origins: _Origins) -> list[_Flow]:
    """Return the wires between nodes that compute, past pass-through nodes, and the files read."""
    flows: dict[_Flow, None] = {}
    for node in graph.nodes.values():
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
    origins: _Origins,
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
    """The data that a node hides, and the nodes that it reaches past the node's plain outputs.

    Parameters
    ----------
    hiding
        The node.
    nodes
        All nodes.
    network
        Without what is declared as known.
    """

    def __init__(
        self, hiding: GraphNode, nodes: Mapping[str, GraphNode], network: nx.MultiDiGraph[str]
    ) -> None:
        self._hiding = hiding.name
        self._nodes = nodes
        self._outputs = _truth_outputs(hiding)
        self._network = network
        sources = nx.ancestors(network, hiding.name) | {hiding.name}
        # in wires, from what lies upstream or from a truth output
        self._distance = nx.multi_source_dijkstra_path_length(_around(hiding, network), sources)

    def check(self, node: GraphNode, problems: Problems) -> None:
        """Record the estimates of a scored node that the truth reaches."""
        estimates = _estimates(node)
        for flow in self._carriers(node.name):
            if flow.port in estimates:
                way = self._way(flow)
                path = " -> ".join([*map(str, way), f"{flow.target}.{flow.port}"])
                problems.add(
                    flow.place,
                    f"{node.name} is scored against what {self._hiding} hides, and can see it: "
                    f"{path}",
                    self._instead(way),
                )

    def _instead(self, way: Sequence[_Flow]) -> str:
        """Return a remedy: the truth of a node that damages it on the way, or another source."""
        for flow in reversed(way):
            truths = _truth_outputs(self._nodes[flow.source]) if flow.output else set()
            if way[0].source == self._hiding != flow.source and truths - {flow.output}:
                return f"score it against {_any_of(flow.source, truths)}, the truth of what it sees"
        plain = set(self._nodes[self._hiding].outputs) - self._outputs
        feed = f"feed it from {_any_of(self._hiding, plain)}, or " if plain else ""
        return f"{feed}declare under 'known' what a method may know"

    def _carriers(self, name: str) -> Iterator[_Flow]:
        """Yield the flows that carry the truth to a node."""
        for flow in _flows_into(name, self._network):
            is_seen = flow.source == self._hiding and flow.output not in self._outputs
            if flow.source in self._distance and not is_seen:
                yield flow

    def _way(self, last: _Flow) -> list[_Flow]:
        """Return the shortest way of the truth that ends with a flow."""
        way = [last]
        while steps := self._distance[way[0].source]:
            before = self._carriers(way[0].source)
            way.insert(0, next(flow for flow in before if self._distance[flow.source] < steps))
        return way


def _any_of(node: str, outputs: Iterable[str]) -> str:
    return " or ".join(f"{node}.{output}" for output in sorted(outputs))


def _estimates(node: GraphNode) -> set[str]:
    """Return the ports that must not see the truth: of a type that a truth port has, else all."""
    estimates: set[str] = set()
    for method in _computing(node):
        truths = [port.type for port in method.node.inputs if port.truth]
        plain = [port for port in method.node.inputs if not port.truth]
        alike = [
            port
            for port in plain
            if any(issubclass(port.type, kind) or issubclass(kind, port.type) for kind in truths)
        ]
        estimates |= {port.name for port in alike or plain}
    return estimates


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
    """Return the files that a node reads, and the folders, of which it takes a file.

    A folder from which a node reads nothing but the truth is left out: what methods may see is in
    another file of it.
    """
    truth_alone = all(port.truth for method in _computing(node) for port in method.node.outputs)
    return {
        str(values[name])
        for method in node.methods.values()
        for values in method.settings.values.values()
        for name, setting in method.node.settings.items()
        if setting.is_file and values.get(name) is not None
        if not (truth_alone and Path(values[name]).is_dir())
    }
