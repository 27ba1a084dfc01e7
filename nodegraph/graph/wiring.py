"""References -> typed wires: does the node exist, does the port, do the types fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.methods import Chosen
from nodegraph.graph.model import Gather, GraphNode
from nodegraph.node import Node
from nodegraph.ports import Port, misfit
from nodegraph.spec.parts import GraphSpec, Reference


def dependencies(chosen: list[Chosen]) -> Iterator[tuple[str, Place]]:
    """Yield the nodes that feed any method of a node, with the places that say so."""
    for method in chosen:
        for fed in method.wiring.values():
            for one in (fed,) if isinstance(fed, Reference) else fed.sources.values():
                yield one.node, one.place


class Wirer:
    """Checks wires against the nodes that have been built so far."""

    def __init__(self, spec: GraphSpec, nodes: Mapping[str, GraphNode], problems: Problems) -> None:
        self._spec = spec
        self._nodes = nodes
        self._problems = problems

    def wire(self, where: str, chosen: Chosen, node: Node) -> dict[str, Reference | Gather]:
        """Return what feeds each port of a method; mistakes are noted."""
        fed: dict[str, Reference | Gather] = {}
        for name, written in chosen.wiring.items():
            port = self._port(where, name, node, written.place)
            if port is None:
                continue
            if isinstance(written, Reference):
                made = self.source(written, port, where)
                fed[port.name] = Gather("", {"": made}) if port.across else made
            elif port.across:
                sources = written.sources.items()
                made_all = {label: self.source(one, port, where) for label, one in sources}
                fed[port.name] = Gather(port.name, made_all)
            else:
                message = f"{where}: port {port.name!r} takes one value, not a mapping of several"
                self._problems.add(written.place, message, "a port typed Across gathers")
        self._note_open_ports(where, chosen, node)
        return fed

    def source(self, written: Reference, target: Port | None, where: str) -> Reference:
        """Return a reference as a source, and note whether it fits the port it feeds."""
        if written.node.startswith("$"):
            message = f"{where}: {written} names a value; a port is fed by a node"
            self._problems.add(written.place, message, nearest(written.node[1:], self._spec.nodes))
        elif written.node not in self._spec.nodes:
            message = f"{where}: no node {written.node!r}"
            self._problems.add(written.place, message, nearest(written.node, self._spec.nodes))
        elif written.node in self._nodes:
            self._check_ports(written, target, where)
        return written

    def _check_ports(self, written: Reference, target: Port | None, where: str) -> None:
        for method in self._nodes[written.node].methods.values():
            found = method.node.output(written.port) if written.port else method.node.outputs[0]
            name = f"{written.node} ({method.node.name})"
            if found is None:
                there = nearest(written.port, [one.name for one in method.node.outputs])
                message = f"{where}: {name} has no output {written.port!r}"
                self._problems.add(written.place, message, there)
            elif target is not None and (said := misfit(found, target)):
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
