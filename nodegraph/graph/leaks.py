"""The leak check: no method may see the answer that it is scored against.

Let a node Q have a required truth port that is fed, at any distance, by a node H that hides
samples (it has a truth output). What lies upstream of H, and H's truth outputs, must not reach
a plain port of Q by a way that does not pass H's plain outputs. The same file read twice is the
same source. Ports that only draw, which are optional, are exempt, and no way leads through what
the graph declares as known.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

from nodegraph.errors import Problems
from nodegraph.graph.model import Graph, GraphNode
from nodegraph.spec.parts import Reference

_Port = tuple[str, str]  # a node, and one of its outputs; a file has the output ""


def check_leaks(graph: Graph, problems: Problems) -> None:
    """Note every way by which a scored method could see its answer."""
    hiders = [name for name, node in graph.nodes.items() if _truth_outputs(node)]
    if not hiders:
        return
    wires = _Wires(graph)
    for name in hiders:
        _check_one(name, wires, problems)


class _Wires:
    """The graph's wires between output ports and nodes, with files as sources."""

    def __init__(self, graph: Graph) -> None:
        self.nodes = graph.nodes
        self.out: dict[str, list[tuple[str, str, str]]] = defaultdict(list)
        self.into: dict[str, list[tuple[str, str, str]]] = defaultdict(list)
        self.places: dict[tuple[str, str, str, str], Reference] = {}
        self.known = {(one.node, one.port) for one in graph.spec.known}
        for target, port, source, _ in graph.wires():
            self._add(source.node, graph.output_name(source), target, port)
            self.places[source.node, graph.output_name(source), target, port] = source
        for node in graph.nodes.values():
            for file in _files(node):
                self._add(f"file {file}", "", node.name, "")

    def is_known(self, name: str, output: str) -> bool:
        return (name, output) in self.known or (name, "") in self.known

    def _add(self, source: str, output: str, target: str, port: str) -> None:
        self.out[source].append((output, target, port))
        self.into[target].append((source, output, port))


def _check_one(hider: str, wires: _Wires, problems: Problems) -> None:
    fed = _downstream(hider, wires)
    came_from = _tainted(hider, wires)
    for name in fed:
        if not _truth_is_fed(name, hider, fed, wires):
            continue
        for source, output, port in wires.into[name]:
            if not _is_truth_port(wires.nodes[name], port) and _carries(
                source, output, hider, came_from, wires
            ):
                _note(hider, (source, output), (name, port), came_from, wires, problems)


def _downstream(start: str, wires: _Wires) -> set[str]:
    found: set[str] = set()
    pending = [start]
    while pending:
        for _, target, _ in wires.out[pending.pop()]:
            if target not in found:
                found.add(target)
                pending.append(target)
    return found


def _upstream(start: str, wires: _Wires) -> set[str]:
    found: set[str] = set()
    pending = [start]
    while pending:
        for source, output, _ in wires.into[pending.pop()]:
            if source not in found and not wires.is_known(source, output):
                found.add(source)
                pending.append(source)
    return found


def _tainted(hider: str, wires: _Wires) -> Mapping[str, _Port | None]:
    """Return every node that the answer reaches, with the port that it came from."""
    came_from: dict[str, _Port | None] = dict.fromkeys(sorted(_upstream(hider, wires)))
    pending = [*came_from, hider]
    while pending:
        name = pending.pop()
        for output, target, _ in wires.out[name]:
            if target in came_from or target == hider:
                continue
            if _carries(name, output, hider, came_from, wires):
                came_from[target] = (name, output)
                pending.append(target)
    return came_from


def _carries(
    source: str, output: str, hider: str, came_from: Mapping[str, _Port | None], wires: _Wires
) -> bool:
    """Whether a wire that leaves this output carries the answer."""
    if wires.is_known(source, output):
        return False
    if source == hider:
        return output in _truth_outputs(wires.nodes[hider])
    return source in came_from


def _truth_outputs(node: GraphNode) -> set[str]:
    outputs = (port for method in node.methods.values() for port in method.node.outputs)
    return {port.name for port in outputs if port.truth}


def _truth_is_fed(name: str, hider: str, fed: set[str], wires: _Wires) -> bool:
    return any(
        _is_required_truth(wires.nodes[name], port) and (source == hider or source in fed)
        for source, _, port in wires.into[name]
    )


def _is_truth_port(node: GraphNode, name: str) -> bool:
    ports = (method.node.port(name) for method in node.methods.values())
    return any(port.truth for port in ports if port is not None)


def _is_required_truth(node: GraphNode, name: str) -> bool:
    ports = (method.node.port(name) for method in node.methods.values())
    return any(port.truth and not port.optional for port in ports if port is not None)


def _files(node: GraphNode) -> set[str]:
    return {
        str(values[name])
        for method in node.methods.values()
        for values in method.settings.values.values()
        for name, setting in method.node.settings.items()
        if setting.is_file and values.get(name) is not None
    }


def _note(
    hider: str,
    last: _Port,
    target: _Port,
    came_from: Mapping[str, _Port | None],
    wires: _Wires,
    problems: Problems,
) -> None:
    way = [last]
    while (before := came_from.get(way[-1][0])) is not None:
        way.append(before)
    steps = [f"{node}.{output}" if output else node for node, output in reversed(way)]
    path = " -> ".join([*steps, ".".join(target)])
    place = (
        wires.places[(*last, *target)].place
        if (*last, *target) in wires.places
        else (wires.nodes[target[0]].place)
    )
    problems.add(
        place,
        f"{target[0]} is scored against what {hider} hides, and can see it: {path}",
        f"feed it from {hider}'s other outputs, or declare under 'known' what a method may know",
    )
