"""A graph file used as a node: its ports, settings and outputs, and whether a node fits them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import networkx as nx

from nodegraph.errors import Place, Problems, nearest, quoted
from nodegraph.graph.methods import shared_and_own
from nodegraph.graph.model import Gather, Graph, method_name, sources_of
from nodegraph.graph.pass_through import PassThrough, graph_stand_in
from nodegraph.graph.settings import common_columns
from nodegraph.graphfile.spec import (
    Gathering,
    GraphSpec,
    MethodSpec,
    NodeSpec,
    Reference,
    Variable,
    Wiring,
    Written,
)
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered

MOST_VALUES = 100_000
MOST_DEPTH = 100

StandIns = Mapping[str, Mapping[str, Registered]]
"""Node -> label of a method -> the pass-through node that stands for a graph or a port."""


@dataclass(frozen=True)
class Subgraph:
    """A graph file as the graphs that use it see it.

    Attributes
    ----------
    spec : GraphSpec
        Flat, with the nodes that lead to its outputs alone: what replaces a node.
    stand_ins : mapping of node to (mapping of label to Registered)
        Nodes that stand in it for the graphs that its own nodes use.
    inputs : mapping of name to Port
        Its inputs that are ports. A port takes the truth, or gathers, if all its readers do.
    outputs : mapping of name to Port
    is_valid : bool
        Whether it has no errors; else its outputs are unknown.
    """

    spec: GraphSpec
    stand_ins: StandIns
    inputs: Mapping[str, Port]
    outputs: Mapping[str, Port]
    is_valid: bool


def invalid_subgraph(spec: GraphSpec, ports: Mapping[str, Port]) -> Subgraph:
    """Return the subgraph of a graph with errors, as far as it is known."""
    inputs = {name: replace(port, truth=True, across=True) for name, port in ports.items()}
    return Subgraph(_without_ports(spec, ports), {}, inputs, {}, is_valid=False)


def subgraph_of(
    graph: Graph, ports: Mapping[str, Port], stand_ins: StandIns, problems: Problems
) -> Subgraph:
    """Return a valid graph as the graphs that use it see it.

    Parameters
    ----------
    graph
    ports
        Its inputs that are ports.
    stand_ins
        Nodes that stand in it for the graphs that its nodes use.
    problems
        Receives what prevents its use.
    """
    inputs = {name: _input(port, graph) for name, port in ports.items()}
    outputs = {
        name: _output(name, source, graph, inputs, problems)
        for name, source in graph.spec.outputs.items()
    }
    for reference in graph.spec.known:
        if reference.node.startswith("$"):
            message = f"known: {reference} comes from outside"
            hint = "declare it in the graph that uses this one"
            problems.add(reference.place, message, hint)
    used = _nodes_used(graph)
    spec = _without_ports(graph.spec, ports)
    methods = [method for name in used for method in graph.nodes[name].methods.values()]
    axes = {axis for method in methods for axis in method.settings.axes}
    spec = replace(
        spec,
        nodes={name: node for name, node in spec.nodes.items() if name in used},
        axes={name: axis for name, axis in spec.axes.items() if name in axes},
        skip=tuple(
            item
            for item in spec.skip
            if any(item.labels.keys() <= set(graph.nodes[name].axes) for name in used)
        ),
        known=tuple(reference for reference in spec.known if reference.node in used),
    )
    inner = {name: stand_in for name, stand_in in stand_ins.items() if name in used}
    return Subgraph(spec, inner, inputs, outputs, is_valid=not problems)


def _without_ports(spec: GraphSpec, ports: Mapping[str, Port]) -> GraphSpec:
    inputs = {name: part for name, part in spec.inputs.items() if name not in ports}
    return replace(spec, inputs=inputs)


def _input(port: Port, graph: Graph) -> Port:
    readers = list(_readers(f"${port.name}", graph))
    return replace(
        port,
        truth=bool(readers) and all(reader.truth for reader, _ in readers),
        across=bool(readers) and all(reader.across and alone for reader, alone in readers),
    )


def _readers(name: str, graph: Graph) -> Iterator[tuple[Port, bool]]:
    """Yield the ports that read a node, and whether they read nothing else."""
    for reader in graph.network.successors(name):
        for method in graph.nodes[reader].methods.values():
            for port_name, feed in method.inputs.items():
                port = method.node.port(port_name)
                if port is not None and any(name == source.node for source in sources_of(feed)):
                    port = replace(port, truth=port.truth or method.node.damages)
                    yield port, not (isinstance(feed, Gather) and feed.axis)


def _output(
    name: str,
    source: Reference,
    graph: Graph,
    inputs: Mapping[str, Port],
    problems: Problems,
) -> Port:
    """Return an output as a port, of the type that all alternatives have in common."""
    if source.node.startswith("$"):
        return replace(inputs[source.node[1:]], name=name, across=False)
    if name in graph.nodes and not _is_node_itself(name, source, graph):
        message = f"output {quoted(name)} is not the node of that name"
        problems.add(source.place, message, "outside, both would have one name; rename the output")
    nodes = [method.node for method in graph.nodes[source.node].methods.values()]
    ports = [node.output(source.port) or node.outputs[0] for node in nodes]
    widest = [port for port in ports if all(issubclass(other.type, port.type) for other in ports)]
    if not widest:
        types = ", ".join(
            f"{port.type.__name__} ({node.name})" for node, port in zip(nodes, ports, strict=True)
        )
        problems.add(source.place, f"output {quoted(name)} has no one type: {types}")
    output_type = (widest or ports)[0].type
    columns = common_columns(ports)
    return Port(name, output_type, truth=any(port.truth for port in ports), columns=columns)


def _is_node_itself(name: str, source: Reference, graph: Graph) -> bool:
    if source.node != name or source.at:
        return False
    methods = graph.nodes[name].methods.values()
    return not source.port or all(m.node.outputs[0].name == source.port for m in methods)


def _nodes_used(graph: Graph) -> set[str]:
    """Return the nodes that lead to the outputs of a graph, without those that are its ports."""
    used = {source.node for source in graph.spec.outputs.values()}
    used |= {node for name in used for node in nx.ancestors(graph.network, name)}
    return {name for name in used if not name.startswith("$")}


@dataclass(frozen=True)
class GraphUse:
    """A node, or one of its alternatives, that uses a graph file."""

    node: NodeSpec
    method: MethodSpec
    graph: Subgraph

    @property
    def where(self) -> str:
        """The node and label for messages."""
        return method_name(self.node.name, self.method.label)

    @property
    def prefix(self) -> str:
        """The prefix of the names of nodes and axes inside: ``clean.``."""
        label = self.method.label
        return f"{self.node.name}.{label}." if label else f"{self.node.name}."

    @property
    def wiring(self) -> Wiring:
        """The wires that feed the graph's ports, shared ones included."""
        return shared_and_own(self.node, self.method, self.stand_in(*self.graph.outputs))

    @property
    def settings(self) -> Mapping[str, Written]:
        """The values for the graph's other inputs; shared settings included."""
        return {**self.node.settings, **self.method.settings}

    def stand_in(self, *outputs: str) -> PassThrough:
        """Return the pass-through node that returns some of the graph's outputs."""
        ports = tuple(self.graph.outputs[name] for name in outputs)
        inputs = tuple(self.graph.inputs.values())
        return graph_stand_in(
            self.method.use, self.graph.spec.title, inputs, ports, tuple(self.graph.outputs)
        )


def check_use(use: GraphUse, problems: Problems) -> bool:
    """Whether a node fits the graph that it uses; record why not."""
    found = list(_misfits(use))
    for place, message, instead in found:
        problems.add(place, f"{use.where}: {message}", instead)
    return use.graph.is_valid and not found


_Misfit = tuple[Place, str, str]
"""A place, what does not fit there, and what to write instead."""


def _misfits(use: GraphUse) -> Iterator[_Misfit]:
    """Yield what of a node does not fit the graph that it uses."""
    graph, place, used = use.graph, use.method.place, use.method.use
    if not graph.spec.outputs:
        yield place, f"{used} has no 'outputs'", "write in that file: outputs: {name: node}"
    yield from _misfits_of_wires(use)
    for name, port in graph.inputs.items():
        if name not in use.wiring:
            message = f"port {name}: {port.type.__name__} of {used} is not fed"
            yield place, message, f"write in: {{{name}: node}}"
    yield from _misfits_of_settings(use)
    if graph.is_valid and expands_too_far(graph.spec, use.settings):
        message = f"with these values, the settings inside {used} grow without bound"
        yield place, message, "each of several graphs puts its input into a list or mapping again"


def _misfits_of_wires(use: GraphUse) -> Iterator[_Misfit]:
    graph = use.graph
    for name, feed in use.wiring.items():
        port = graph.inputs.get(name)
        if port is None:
            missing = f"no input port {quoted(name)}" if name else "no input port"
            hint = nearest(name, graph.inputs, what="ports")
            if name in graph.spec.inputs:
                hint = f"it is a setting: with: {{{name}: value}}"
            yield feed.place, f"{use.method.use} has {missing}", hint
        elif isinstance(feed, Gathering) and not port.across:
            message = f"port {quoted(name)} takes one value, not a mapping of several"
            yield feed.place, message, f"inside, ${name} feeds ports that do not gather"


def _misfits_of_settings(use: GraphUse) -> Iterator[_Misfit]:
    graph = use.graph
    settings = settings_in(graph.spec.nodes.values())
    read = dict.fromkeys(variable for each in settings for variable in each.variables())
    for name, written in use.settings.items():
        if name not in graph.spec.inputs:
            hint = nearest(name, graph.spec.inputs, what="settings")
            if name in graph.inputs:
                hint = f"it is a port: in: {{{name}: node}}"
            yield written.place, f"{use.method.use} has no setting {quoted(name)}", hint
            continue
        what = f"setting {quoted(name)} of {use.method.use}"
        fields = [variable.field for variable in read if variable.name == name]
        if graph.is_valid and not fields:
            message = f"{what} leads to none of its outputs"
            yield written.place, message, "leave it out: it would change nothing"
        for field in fields if graph.is_valid else ():
            try:
                field_of(written.value, field)
            except KeyError:
                known = list(written.value) if isinstance(written.value, dict) else []
                hint = nearest(field, known, what="fields")
                yield written.place, f"{what} needs {quoted(field)}", hint


def field_of(value: object, name: str) -> object:
    """Return a field of a value, or of what a variable stands for; without a name, the value.

    Raises
    ------
    KeyError
        If the value has no such field.
    """
    if not name:
        return value
    if isinstance(value, Variable) and not value.field:
        return replace(value, field=name)
    if isinstance(value, dict):
        return value[name]
    raise KeyError(name)


def settings_in(nodes: Iterable[NodeSpec]) -> Iterator[Written]:
    """Yield every setting of nodes and of their methods."""
    for node in nodes:
        yield from node.settings.values()
        for method in node.methods:
            yield from method.settings.values()


def expands_too_far(spec: GraphSpec, settings: Mapping[str, Written]) -> bool:
    """Whether a graph's settings grow without bound when these values are substituted in them.

    Each graph of a chain of graphs may double its input before it passes it on.
    """
    extents = {name: _extent(written.value) for name, written in settings.items()}
    total = 0
    for written in settings_in(spec.nodes.values()):
        size, depth = _extent(written.value)
        inserted = [extents[name.name] for name in written.variables() if name.name in extents]
        depth += max((inner for _, inner in inserted), default=0)
        total += size + sum(count for count, _ in inserted)
        if total > MOST_VALUES or depth > MOST_DEPTH:
            return True
    return False


def _extent(value: object) -> tuple[int, int]:
    """Return the number of values inside a value, and the depth of their nesting."""
    size = depth = 0
    pending = [(value, 0)]
    while pending:
        current, level = pending.pop()
        size, depth = size + 1, max(depth, level)
        if isinstance(current, (dict, list)):
            items = current.values() if isinstance(current, dict) else current
            pending.extend((item, level + 1) for item in items)
    return size, depth
