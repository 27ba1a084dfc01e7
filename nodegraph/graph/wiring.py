"""References -> typed wires: does the node exist, does the port, do the types fit."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.choices import Names
from nodegraph.graph.methods import Chosen
from nodegraph.graph.model import Gather, GraphNode, offered
from nodegraph.graphfile.spec import Gathering, GraphSpec, Reference
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port, mismatch

if TYPE_CHECKING:
    import networkx as nx


def dependencies(chosen: list[Chosen]) -> Iterator[tuple[str, Place]]:
    """Yield the nodes that feed any method of a node, with the places that say so."""
    for method in chosen:
        for fed in method.wiring.values():
            for _, one in labelled(fed):
                yield one.node, one.place


def labelled(fed: Reference | Gathering) -> Iterable[tuple[str, Reference]]:
    """Return what feeds a port with its labels; a single source has the empty label."""
    return (("", fed),) if isinstance(fed, Reference) else fed.sources.items()


class Wirer:
    """Checks wires against the nodes that have been built so far."""

    def __init__(
        self, spec: GraphSpec, nodes: Mapping[str, GraphNode], names: Names, problems: Problems
    ) -> None:
        self._spec = spec
        self._nodes = nodes
        self._names = names
        self._problems = problems

    def wire(self, where: str, chosen: Chosen, node: Node) -> dict[str, Reference | Gather]:
        """Return what feeds each port of a method; mistakes are noted."""
        fed: dict[str, Reference | Gather] = {}
        for name, written in chosen.wiring.items():
            port = self._port(where, name, node, written.place)
            made = {label: self.source(one, port, where) for label, one in labelled(written)}
            if port is None:
                continue
            if isinstance(written, Reference):
                fed[port.name] = Gather("", made) if port.across else made[""]
            elif port.across:
                fed[port.name] = Gather(port.name, made)
            else:
                message = f"{where}: port {port.name!r} takes one value, not a mapping of several"
                self._problems.add(written.place, message, "a port typed Across gathers")
        self._note_open_ports(where, chosen, node)
        return fed

    def look_up(self, where: str, chosen: Chosen) -> None:
        """Note references to what is not there, for a method of which nothing else is known."""
        for written in chosen.wiring.values():
            for _, one in labelled(written):
                self.source(one, None, where)

    def source(self, written: Reference, target: Port | None, where: str) -> Reference:
        """Return a reference as a source, and note whether it fits the port it feeds."""
        name = written.node
        if name.startswith("$"):
            self._names.used.add(name[1:])
        if written.passed:
            return written  # checked where it was given to the graph that this is a part of
        if name in self._spec.nodes:
            if name in self._nodes:
                self._check_ports(written, target, where)
        elif name.startswith("$"):
            message = f"{where}: {written} names a value; a port is fed by a node"
            self._problems.add(written.place, message, self._instead_of_value(name))
        else:
            self._problems.add(written.place, f"{where}: no node {name!r}", self._nearest(name))
        return written

    def _instead_of_value(self, name: str) -> str:
        """Return what could be meant: a port whose type's name is unknown, or a node."""
        value = self._names.inputs.get(name[1:])
        if isinstance(value, str):
            return f"{name[1:]!r} is a port only if {value!r} is the name of a port's type"
        return self._nearest(name)

    def _nearest(self, name: str) -> str:
        return nearest(name, [one for one in self._spec.nodes if "." not in one])

    def _check_ports(self, written: Reference, target: Port | None, where: str) -> None:
        for method in self._nodes[written.node].methods.values():
            found = method.node.output(written.port) if written.port else method.node.outputs[0]
            name = f"{written.node} ({method.node.name})"
            if found is None:
                there = nearest(written.port, offered(method.node))
                message = f"{where}: {name} has no output {written.port!r}"
                self._problems.add(written.place, message, there)
            elif target is not None and (said := mismatch(found, target)):
                self._problems.add(written.place, f"{where}: {name}: {said}")

    def _port(self, where: str, name: str, node: Node, place: Place) -> Port | None:
        found = node.port(name) if name else next(iter(node.inputs), None)
        if found is None:
            there = nearest(name, [port.name for port in node.inputs], what="ports")
            what = f"no input port {name!r}" if name else "no input port"
            self._problems.add(place, f"{where}: {node.name} has {what}", there)
        return found

    def _note_open_ports(self, where: str, chosen: Chosen, node: Node) -> None:
        first = node.inputs[0].name if node.inputs else ""
        fed = {name or first for name in chosen.wiring}
        for port in node.inputs:
            if not port.optional and port.name not in fed:
                message = f"{where}: port {port} of {node.name} is not fed"
                self._problems.add(chosen.place, message, f"write in: {{{port.name}: node}}")


def sorted_names(wires: Mapping[str, Sequence[tuple[str, Place]]], problems: Problems) -> list[str]:
    """Return the nodes in order, as the file has them where it can.

    Parameters
    ----------
    wires
        For each node, what feeds it and where the file says so. Unknown names are passed over.
    problems
        Where a cycle is noted, with the way around it. What is part of one comes in any order,
        so that the rest can be checked.
    """
    needs = {name: {one for one, _ in feeds if one in wires} for name, feeds in wires.items()}
    order = _in_order(needs)
    if len(order) == len(wires):
        return order
    return _in_order(_without_cycles(needs, wires, problems))


def _in_order(needs: Mapping[str, set[str]]) -> list[str]:
    """Return the names, each after its needs and as early as it stands; none of a cycle."""
    names = list(needs)
    waiting = [len(feeds) for feeds in needs.values()]
    readers: dict[str, list[int]] = {name: [] for name in names}
    for index, feeds in enumerate(needs.values()):
        for one in feeds:
            readers[one].append(index)
    ready = [index for index, count in enumerate(waiting) if not count]
    order: list[str] = []
    while ready:
        name = names[heapq.heappop(ready)]
        order.append(name)
        for reader in readers[name]:
            waiting[reader] -= 1
            if not waiting[reader]:
                heapq.heappush(ready, reader)
    return order


def _without_cycles(
    needs: Mapping[str, set[str]],
    wires: Mapping[str, Sequence[tuple[str, Place]]],
    problems: Problems,
) -> dict[str, set[str]]:
    """Note a way around each knot of nodes that feed each other; return what else they need."""
    import networkx as nx  # late: to import it takes as long as to check most graphs

    network: nx.DiGraph[str] = nx.DiGraph()
    network.add_nodes_from(needs)
    network.add_edges_from((one, name) for name, feeds in needs.items() for one in feeds)
    left = dict(needs)
    for knot in nx.strongly_connected_components(network):
        _note_cycle(network.subgraph(knot), wires, problems)
        left |= {name: needs[name] - knot for name in knot}
    return left


def _note_cycle(
    knot: nx.DiGraph[str], wires: Mapping[str, Sequence[tuple[str, Place]]], problems: Problems
) -> None:
    """Note one way around a set of nodes that feed each other."""
    import networkx as nx

    if not knot.number_of_edges():
        return
    around = [source for source, _ in nx.find_cycle(knot, source=min(knot))]
    last, first = around[-1], around[0]
    place = next(place for source, place in wires[first] if source == last)
    problems.add(place, f"{first!r} feeds itself: {' -> '.join([*around, first])}")
