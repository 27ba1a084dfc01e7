"""The leak check: no method may see the answer that it is scored against.

Let a node Q have a required truth port that is fed, at any distance, by a node H that hides
samples (it has a truth output). What lies upstream of H, and H's truth outputs, must not reach
a plain port of Q by a way that does not pass H's plain outputs. The same file read twice is the
same source. Ports that only draw, which are optional, are exempt, and no way leads through what
the graph declares as known. A node that only hands on is neither H nor Q: what it hands on comes
from where it got it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from nodegraph.errors import Place, Problems
from nodegraph.graph.model import Graph, GraphNode, HandsOn, Method, sources_of
from nodegraph.node.ports import Port


def check_leaks(graph: Graph, problems: Problems) -> None:
    """Note every way by which a scored method could see its answer."""
    hiders = [name for name, node in graph.nodes.items() if _truth_outputs(node)]
    if not hiders:
        return
    wires = _Wires(graph)
    for name in hiders:
        _check_one(name, wires, problems)


@dataclass(frozen=True, slots=True)
class _Wire:
    """From an output of a node, or a file, to a port of another; known if a method may know it."""

    source: str
    output: str
    target: str
    port: str
    known: bool
    place: Place

    def __str__(self) -> str:
        return f"{self.source}.{self.output}" if self.output else self.source


class _Wires:
    """The graph's wires, past the nodes that only hand on, with files as sources."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._known = {(one.node, one.port) for one in graph.spec.known}
        self._origins: dict[tuple[str, str], dict[tuple[str, str, bool], None]] = {}
        self.nodes = graph.nodes
        self.out: dict[str, list[_Wire]] = defaultdict(list)
        self.into: dict[str, list[_Wire]] = defaultdict(list)
        for node in graph.nodes.values():
            self._hand_on(node)
            for wire in dict.fromkeys(self._into(node)):
                self.out[wire.source].append(wire)
                self.into[wire.target].append(wire)

    def _hand_on(self, node: GraphNode) -> None:
        """Note where the outputs of a node come from: itself, or what it hands on."""
        for output in {port.name for one in node.methods.values() for port in one.node.outputs}:
            known = not self._known.isdisjoint({(node.name, output), (node.name, "")})
            found = self._origins[node.name, output] = {}
            for method in node.methods.values():
                for name, origin, is_known in self._origins_of(node, method, output):
                    found[name, origin, is_known or known] = None

    def _origins_of(
        self, node: GraphNode, method: Method, output: str
    ) -> Iterator[tuple[str, str, bool]]:
        if not isinstance(method.node, HandsOn):
            yield node.name, output, False
            return
        names = [port.name for port in method.node.outputs]
        # first outputs may differ in name among alternatives
        taken = method.node.inputs[names.index(output) if output in names else 0].name
        for source in sources_of(method.inputs[taken]):
            yield from self._origins[source.node, self._graph.output_name(source)]

    def _into(self, node: GraphNode) -> Iterator[_Wire]:
        for method in _computing(node):
            for port, fed in method.inputs.items():
                for one in sources_of(fed):
                    at = (one.node, self._graph.output_name(one))
                    for source, output, known in self._origins[at]:
                        yield _Wire(source, output, node.name, port, known, one.place)
        for file in _files(node):
            yield _Wire(f"file {file}", "", node.name, "", False, node.place)


def _check_one(hider: str, wires: _Wires, problems: Problems) -> None:
    fed = _downstream(hider, wires)
    came_from = _tainted(hider, wires)
    for name in fed:
        if not _truth_is_fed(name, hider, fed, wires):
            continue
        for wire in wires.into[name]:
            ports = _ports(wires.nodes[name], wire.port)
            if not any(one.truth for one in ports) and _carries(wire, hider, came_from, wires):
                _note(hider, wire, came_from, problems)


def _downstream(start: str, wires: _Wires) -> dict[str, None]:
    found: dict[str, None] = {}
    pending = [start]
    while pending:
        for wire in wires.out[pending.pop()]:
            if wire.target not in found:
                found[wire.target] = None
                pending.append(wire.target)
    return found


def _upstream(start: str, wires: _Wires) -> set[str]:
    found: set[str] = set()
    pending = [start]
    while pending:
        for wire in wires.into[pending.pop()]:
            if wire.source not in found and not wire.known:
                found.add(wire.source)
                pending.append(wire.source)
    return found


def _tainted(hider: str, wires: _Wires) -> Mapping[str, _Wire | None]:
    """Return every node that the answer reaches, with the wire by which it came."""
    came_from: dict[str, _Wire | None] = dict.fromkeys(sorted(_upstream(hider, wires)))
    pending = [*came_from, hider]
    while pending:
        for wire in wires.out[pending.pop()]:
            if wire.target in came_from or wire.target == hider:
                continue
            if _carries(wire, hider, came_from, wires):
                came_from[wire.target] = wire
                pending.append(wire.target)
    return came_from


def _carries(wire: _Wire, hider: str, came_from: Mapping[str, _Wire | None], wires: _Wires) -> bool:
    """Whether a wire carries the answer."""
    if wire.known:
        return False
    if wire.source == hider:
        return wire.output in _truth_outputs(wires.nodes[hider])
    return wire.source in came_from


def _computing(node: GraphNode) -> Iterator[Method]:
    """Yield the methods that do more than hand on."""
    return (one for one in node.methods.values() if not isinstance(one.node, HandsOn))


def _truth_outputs(node: GraphNode) -> set[str]:
    return {port.name for one in _computing(node) for port in one.node.outputs if port.truth}


def _truth_is_fed(name: str, hider: str, fed: Mapping[str, None], wires: _Wires) -> bool:
    return any(
        any(one.truth and not one.optional for one in _ports(wires.nodes[name], wire.port))
        and (wire.source == hider or wire.source in fed)
        for wire in wires.into[name]
    )


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


def _note(
    hider: str, last: _Wire, came_from: Mapping[str, _Wire | None], problems: Problems
) -> None:
    way = [last]
    while (before := came_from.get(way[-1].source)) is not None:
        way.append(before)
    path = " -> ".join([*map(str, reversed(way)), f"{last.target}.{last.port}"])
    problems.add(
        last.place,
        f"{last.target} is scored against what {hider} hides, and can see it: {path}",
        f"feed it from {hider}'s other outputs, or declare under 'known' what a method may know",
    )
