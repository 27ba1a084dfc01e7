"""References -> typed wires: does the node exist, does the port, do the types fit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.choices import Names
from nodegraph.graph.hands_on import offered
from nodegraph.graph.methods import Chosen
from nodegraph.graph.model import Gather, GraphNode
from nodegraph.node import Node
from nodegraph.ports import Port, misfit
from nodegraph.spec.parts import Gathering, GraphSpec, Reference


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
