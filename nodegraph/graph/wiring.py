"""Check references: node and port exist, types match, and no node feeds itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice

import networkx as nx

from nodegraph.errors import Hint, Place, Problems, listed, nearest, quoted
from nodegraph.graph.methods import ResolvedMethod
from nodegraph.graph.model import Gather, GraphNode, Wire, sources_of
from nodegraph.graph.namespace import Namespace
from nodegraph.graph.pass_through import public_outputs
from nodegraph.graphfile.spec import GraphSpec, Reference
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port, mismatch


class WireChecker:
    """Resolves what feeds a node, against the nodes that are built already."""

    def __init__(
        self,
        spec: GraphSpec,
        nodes: Mapping[str, GraphNode],
        namespace: Namespace,
        problems: Problems,
    ) -> None:
        self._spec = spec
        self._nodes = nodes
        self._namespace = namespace
        self._problems = problems
        self._noted: set[tuple[Place, str]] = set()

    def inputs(
        self, where: str, method: ResolvedMethod, node: Node
    ) -> dict[str, Reference | Gather]:
        """Return the source of each port of a method; `where` names the method in messages."""
        inputs: dict[str, Reference | Gather] = {}
        for name, feed in method.wiring.items():
            port = self._port(where, name, node, feed.place)
            sources = {"": feed} if isinstance(feed, Reference) else feed.sources
            target = port
            if port is not None and node.damages and not port.truth:
                target = replace(port, truth=True)
            for reference in sources.values():
                self.check(reference, target, where)
            if port is None:
                continue
            if isinstance(feed, Reference):
                inputs[port.name] = Gather("", sources) if port.across else feed
            elif port.across:
                inputs[port.name] = Gather(port.name, sources)
            else:
                message = f"port {quoted(port.name)} takes one value, not a mapping of several"
                self._note(feed.place, where, message, "a port typed Across gathers")
        self._check_open_ports(where, method, node)
        return inputs

    def check(self, reference: Reference, target: Port | None, where: str) -> None:
        """Check a reference, and that it fits the port that it feeds, if that is known."""
        name = reference.node
        if name.startswith("$"):
            self._namespace.used.add(name[1:])
        if reference.passed:
            return  # checked at the port of the graph used as a node, to which it is written
        if name in self._spec.nodes:
            if name in self._nodes:
                self._check_output(reference, target, where)
        elif name.startswith("$"):
            message = f"{reference} names a value; a port is fed by a node"
            self._note(reference.place, where, message, self._instead_of_value(name))
        else:
            hint = partial(self._instead_of, name, reference.port)
            self._note(reference.place, where, f"no node {quoted(name)}", hint)

    def _note(self, place: Place, where: str, message: str, hint: Hint) -> None:
        """Note an error once, by the first of the methods that share the reference."""
        if (place, message) not in self._noted:
            self._noted.add((place, message))
            self._problems.add(place, f"{listed([where])}: {message}", hint)

    def _instead_of(self, name: str, port: str) -> str:
        """Return what to write: nodes that use an installed node of the name, or the nearest."""
        used_by = [
            node.name
            for node in self._nodes.values()
            if any(method.node.name == f"{name}.{port}" for method in node.methods.values())
        ]
        return f"write {' or '.join(used_by)}" if used_by else self._nearest(name)

    def _instead_of_value(self, name: str) -> str:
        """Return a suggestion: a port whose type is unknown, or a node."""
        value = self._namespace.inputs.get(name[1:])
        if isinstance(value, str):
            return (
                f"{quoted(name[1:])} is a port only if {quoted(value)} is the name of a port's type"
            )
        return self._nearest(name)

    def _nearest(self, name: str) -> str:
        return nearest(name, [node for node in self._spec.nodes if "." not in node])

    def _check_output(self, reference: Reference, target: Port | None, where: str) -> None:
        wrong: dict[tuple[str, str], list[str]] = {}  # nodes, by what is wrong and the hint
        for method in self._nodes[reference.node].methods.values():
            node, name = method.node, reference.port
            output = node.output(name) if name else node.outputs[0]
            if output is None:
                reason = f" has no output {quoted(name)}"
                hint = nearest(name, public_outputs(node))
            elif target is not None and (misfit := mismatch(output, target)):
                reason = f": {misfit}"
                is_hidden = output.truth and not target.truth
                hint = _instead_of_truth(reference, node, target) if is_hidden else ""
            else:
                continue
            wrong.setdefault((reason, hint), []).append(node.name)
        for (reason, hint), names in wrong.items():
            source = f"{reference.node} ({listed(dict.fromkeys(names), most=2)})"
            self._note(reference.place, where, f"{source}{reason}", hint)

    def _port(self, where: str, name: str, node: Node, place: Place) -> Port | None:
        port = node.port(name) if name else next(iter(node.inputs), None)
        if port is None:
            hint = nearest(name, [port.name for port in node.inputs], what="ports")
            missing = f"no input port {quoted(name)}" if name else "no input port"
            self._problems.add(place, f"{where}: {node.name} has {missing}", hint)
        return port

    def _check_open_ports(self, where: str, method: ResolvedMethod, node: Node) -> None:
        first = node.inputs[0].name if node.inputs else ""
        wired = {name or first for name in method.wiring}
        for port in node.inputs:
            if not port.optional and port.name not in wired:
                message = f"{where}: port {port} of {node.name} is not fed"
                hint = partial(self._wire_to, port, len(self._nodes))
                self._problems.add(method.place, message, hint)

    def _wire_to(self, port: Port, count: int) -> str:
        """Return what to write: of the first nodes, the only output that fits, or a placeholder."""
        fitting = [
            f"{name}.{output.name}"
            for name, node in islice(self._nodes.items(), count)
            if node.methods
            for output in node.first.node.outputs
            if not mismatch(output, port)
        ]
        return f"write in: {{{port.name}: {fitting[0] if len(fitting) == 1 else 'node'}}}"


def _instead_of_truth(reference: Reference, node: Node, target: Port) -> str:
    """Return what to write: outputs that fit the port, and what the truth may feed."""
    outputs = [port for port in node.outputs if not mismatch(port, target)]
    names = " or ".join(f"{reference.node}.{port.name}" for port in outputs)
    write = f"write {target.name}: {names}; " if names else ""
    return (
        f"{write}the truth feeds truth ports, and plain ports of nodes that damage it "
        "(which have a truth output of their own)"
    )


def typed_network(nodes: Mapping[str, GraphNode]) -> nx.MultiDiGraph[str]:
    """Return the network of a graph; see `nodegraph.graph.Graph`."""
    network: nx.MultiDiGraph[str] = nx.MultiDiGraph()
    network.add_nodes_from((name, {"record": node}) for name, node in nodes.items())
    for name, node in nodes.items():
        for method in node.methods.values():
            for port, feed in method.inputs.items():
                for source in sources_of(feed):
                    output = source.port or nodes[source.node].first.node.outputs[0].name
                    wire = Wire(output, port, source, isinstance(feed, Gather))
                    # methods that share a reference share its edge
                    network.add_edge(source.node, name, (port, source.place), record=wire)
    return network


def sorted_names(sources: Mapping[str, Sequence[Reference]], problems: Problems) -> list[str]:
    """Return the nodes, each after those that feed it, and else as the file has them.

    Parameters
    ----------
    sources
        For each node, the references that feed it; those to unknown nodes are ignored.
    problems
        Receives each cycle. Its nodes come in any order, so that the rest can be checked.
    """
    position = {name: index for index, name in enumerate(sources)}
    if all(
        position.get(reference.node, -1) < index
        for index, references in enumerate(sources.values())
        for reference in references
    ):
        return list(sources)  # most files are in order, and to sort costs a third of the check
    network: nx.DiGraph[str] = nx.DiGraph()
    network.add_nodes_from(sources)
    network.add_edges_from(
        (reference.node, name)
        for name, references in sources.items()
        for reference in references
        if reference.node in sources
    )
    if not nx.is_directed_acyclic_graph(network):
        _remove_cycles(network, sources, problems)
    return list(nx.lexicographical_topological_sort(network, key=position.__getitem__))


def _remove_cycles(
    network: nx.DiGraph[str], sources: Mapping[str, Sequence[Reference]], problems: Problems
) -> None:
    """Record a cycle of each strongly connected component, and remove the component's edges."""
    for component in list(nx.strongly_connected_components(network)):
        inner = network.subgraph(component)
        if not inner.number_of_edges():
            continue
        cycle = [source for source, _ in nx.find_cycle(inner, source=min(component))]
        first, last = cycle[0], cycle[-1]
        place = next(source.place for source in sources[first] if source.node == last)
        problems.add(place, f"{quoted(first)} feeds itself: {' -> '.join([*cycle, first])}")
        network.remove_edges_from(list(inner.edges))
