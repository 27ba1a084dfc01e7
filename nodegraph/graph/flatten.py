"""Replace the nodes of a graph that use graph files by the nodes of these files."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

from nodegraph.errors import Place, Problems, quoted
from nodegraph.graph.model import sources_of
from nodegraph.graph.pass_through import PassThrough, port_stand_in
from nodegraph.graph.subgraph import GraphUse, StandIns, Subgraph, check_use, field_of
from nodegraph.graphfile.spec import (
    AxisSpec,
    Gathering,
    GraphSpec,
    MethodSpec,
    NodeSpec,
    Reference,
    SkipSpec,
    Variable,
    Wiring,
    Written,
    rewired,
    with_leaves,
)
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered

_Reference = TypeVar("_Reference", bound=Reference)


@dataclass(frozen=True)
class GraphInput:
    """A reference to a node that feeds a port of a graph used as a node.

    Attributes
    ----------
    where : str
        Names the using node in messages.
    port : Port or None
        None if the graph has no such port; the error is recorded.
    """

    where: str
    port: Port | None
    source: Reference


@dataclass(frozen=True)
class FlatGraph:
    """A graph in which no node uses another graph any more.

    Attributes
    ----------
    spec : GraphSpec
        Its nodes are its own, those that stand for its ports (``$recording``), and those of the
        graphs that it uses (``clean.despike``).
    ports : mapping of name to Port
        Its inputs that are ports.
    stand_ins : mapping of node to (mapping of label to Registered)
        Nodes that stand for its ports, and for the graphs that its nodes use.
    inputs : tuple of GraphInput
        Inputs that feed the graphs that it uses.
    settings : tuple of Written
        The settings of the graphs that it uses.
    is_complete : bool
        Whether every node that uses a graph could be replaced.
    """

    spec: GraphSpec
    ports: Mapping[str, Port]
    stand_ins: StandIns
    inputs: tuple[GraphInput, ...]
    settings: tuple[Written, ...]
    is_complete: bool


def flatten(
    spec: GraphSpec,
    ports: Mapping[str, Port],
    subgraph: Callable[[Path], Subgraph],
    problems: Problems,
) -> FlatGraph:
    """Return a graph in which the nodes that use graph files are replaced.

    Parameters
    ----------
    spec
    ports
        Its inputs that are ports.
    subgraph
        Returns the checked graph of a file.
    problems
        Receives errors in the use of graphs.
    """
    if not ports and not any(method.is_graph for _, method in _methods(spec)):
        return FlatGraph(spec, {}, {}, (), (), is_complete=True)
    return _Flattening(spec, ports, subgraph, problems).flat_graph()


def _methods(spec: GraphSpec) -> Iterator[tuple[NodeSpec, MethodSpec]]:
    return ((node, method) for node in spec.nodes.values() for method in node.methods)


class _Flattening:
    def __init__(
        self,
        spec: GraphSpec,
        ports: Mapping[str, Port],
        subgraph: Callable[[Path], Subgraph],
        problems: Problems,
    ) -> None:
        self._spec = spec
        self._ports = ports
        self._problems = problems
        self._nodes: dict[str, NodeSpec] = {}
        self._axes = dict(spec.axes)
        self._skip = list(spec.skip)
        self._known: list[Reference] = []
        self._requires = dict.fromkeys(spec.requires)
        self._stand_ins: dict[str, Mapping[str, Registered]] = {}
        self._inputs: list[GraphInput] = []
        self._settings: list[Written] = []
        self._uses = {
            (node.name, method.label): GraphUse(node, method, subgraph(path))
            for node, method in _methods(spec)
            if method.is_graph and (path := spec.uses.get(method.use)) is not None
        }
        self._fitting = {key for key, use in self._uses.items() if check_use(use, problems)}

    def flat_graph(self) -> FlatGraph:
        for name, port in self._ports.items():
            self._add_stand_in(f"${name}", port_stand_in(port), self._spec.inputs[name].place, {})
        for node in self._spec.nodes.values():
            methods = tuple(self._method(node, method) for method in node.methods)
            wiring = self._redirected_wiring(node.wiring)
            self._nodes[node.name] = replace(node, methods=methods, wiring=wiring)
        outputs = self._spec.outputs.items()
        spec = replace(
            self._spec,
            nodes=self._nodes,
            axes=self._axes,
            skip=tuple(self._skip),
            known=(*self._all_outputs(self._spec.known), *self._known),
            requires=tuple(self._requires),
            outputs={name: self._redirected(source) for name, source in outputs},
            report=tuple(self._all_outputs(self._spec.report)),
            written=self._spec,
        )
        uses = sum(method.is_graph for _, method in _methods(self._spec))
        return FlatGraph(
            spec,
            self._ports,
            self._stand_ins,
            tuple(self._inputs),
            tuple(self._settings),
            is_complete=len(self._fitting) == uses,
        )

    def _method(self, node: NodeSpec, method: MethodSpec) -> MethodSpec:
        """Return a method; one that uses a graph passes on the outputs of the nodes inside."""
        if not method.is_graph:
            return replace(method, wiring=self._redirected_wiring(method.wiring))
        use = self._uses.get((node.name, method.label))
        if use is not None:
            self._add_inputs(use)
        if use is None or (node.name, method.label) not in self._fitting:
            return replace(method, use="", wiring=self._redirected_wiring(method.wiring))
        inlined = _Inlined(
            use.prefix, use.graph.spec, self._redirected_wiring(use.wiring), use.settings
        )
        self._add_nodes(inlined, use)
        outputs = inlined.wiring(use.graph.spec.outputs)
        if not node.has_alternatives:
            outputs = self._first_alone(use, outputs)
        stand_in = Registered(use.stand_in(*outputs), "nodegraph")
        self._stand_ins[node.name] = {**self._stand_ins.get(node.name, {}), method.label: stand_in}
        return replace(method, wiring=outputs, settings={})

    def _first_alone(self, use: GraphUse, outputs: Wiring) -> Wiring:
        """Return the first output; add nodes for the others, except those that are nodes."""
        first, *rest = outputs
        for name in rest:
            if name not in use.graph.spec.nodes:
                wiring = {name: outputs[name]}
                self._add_stand_in(use.prefix + name, use.stand_in(name), use.node.place, wiring)
        return {first: outputs[first]}

    def _add_stand_in(self, name: str, node: PassThrough, place: Place, wiring: Wiring) -> None:
        method = MethodSpec("", node.name, place, wiring)
        self._nodes[name] = NodeSpec(name, place, (method,), False, {}, {}, None)
        self._stand_ins[name] = {"": Registered(node, "nodegraph")}

    def _add_inputs(self, use: GraphUse) -> None:
        self._settings.extend(use.settings.values())
        for name, feed in self._redirected_wiring(use.wiring).items():
            port = use.graph.inputs.get(name)
            self._inputs += [GraphInput(use.where, port, source) for source in sources_of(feed)]

    def _add_nodes(self, inlined: _Inlined, use: GraphUse) -> None:
        for node in inlined.nodes():
            if node.name in self._nodes:
                message = f"two nodes would be called {quoted(node.name)}"
                instead = f"rename the label {quoted(use.method.label)}"
                self._problems.add(use.method.place, message, instead)
            self._nodes[node.name] = node
        self._axes |= {axis.name: axis for axis in inlined.axes()}
        self._skip.extend(inlined.skip())
        self._known.extend(inlined.known())
        self._requires |= dict.fromkeys(use.graph.spec.requires)
        for name, stand_ins in use.graph.stand_ins.items():
            self._stand_ins[inlined.prefix + name] = stand_ins

    def _redirected_wiring(self, wiring: Wiring) -> Wiring:
        """Return wires that lead to the nodes which return the outputs of used graphs."""
        if not self._fitting:
            return wiring
        return {port: rewired(feed, self._redirected) for port, feed in wiring.items()}

    def _redirected(self, source: _Reference) -> _Reference:
        if (source.node, "") not in self._fitting:
            return source
        use = self._uses[source.node, ""]
        _, *rest = use.graph.outputs
        if source.port in rest:
            return replace(source, node=use.prefix + source.port, port="")
        return source

    def _all_outputs(self, references: Iterable[_Reference]) -> Iterator[_Reference]:
        """Yield references to nodes; that to a node which uses a graph means all its outputs."""
        for reference in references:
            ports = [reference.port]
            if not reference.port and (reference.node, "") in self._fitting:
                ports = ["", *list(self._uses[reference.node, ""].graph.outputs)[1:]]
            yield from (self._redirected(replace(reference, port=port)) for port in ports)


@dataclass(frozen=True)
class _Inlined:
    """The parts of a graph file in the place of a node that uses it.

    Attributes
    ----------
    prefix : str
        Precedes the names of its nodes and axes: ``clean.``.
    spec : GraphSpec
        The graph, flat.
    feeds : mapping of port to Reference or Gathering
        The sources of its ports.
    settings : mapping of input to Written
        The values of its other inputs, where they are set.
    """

    prefix: str
    spec: GraphSpec
    feeds: Wiring
    settings: Mapping[str, Written]

    def nodes(self) -> Iterator[NodeSpec]:
        """Yield its nodes."""
        for node in self.spec.nodes.values():
            yield replace(
                node,
                name=self.prefix + node.name,
                methods=tuple(map(self._method, node.methods)),
                wiring=self.wiring(node.wiring),
                settings=self._settings(node.settings),
                over=node.over and tuple((self.prefix + axis, at) for axis, at in node.over),
                prefix=self.prefix + node.prefix,
            )

    def axes(self) -> Iterator[AxisSpec]:
        """Yield its axes."""
        for axis in self.spec.axes.values():
            folder = axis.folder or self.spec.folder
            yield replace(axis, name=self.prefix + axis.name, folder=folder)

    def skip(self) -> Iterator[SkipSpec]:
        """Yield the combinations that it skips."""
        for item in self.spec.skip:
            labels = {self.prefix + axis: labels for axis, labels in item.labels.items()}
            yield replace(item, labels=labels)

    def known(self) -> Iterator[Reference]:
        """Yield what it declares as known."""
        return map(self._renamed, self.spec.known)

    def wiring(self, wiring: Wiring) -> Wiring:
        """Return wires between its nodes, and those that come in at its ports."""
        return {port: self._feed(feed) for port, feed in wiring.items()}

    def _method(self, method: MethodSpec) -> MethodSpec:
        if not method.wiring and not method.settings:
            return method
        wiring, settings = self.wiring(method.wiring), self._settings(method.settings)
        return replace(method, wiring=wiring, settings=settings)

    def _feed(self, feed: Reference | Gathering) -> Reference | Gathering:
        if isinstance(feed, Gathering):
            return rewired(feed, self._source)
        if not feed.node.startswith("$"):
            return self._renamed(feed)
        return rewired(self.feeds[feed.node[1:]], partial(replace, passed=True))

    def _source(self, source: Reference) -> Reference:
        feed = self._feed(source)
        assert isinstance(feed, Reference), "a port that feeds one of several takes one value"
        return feed

    def _renamed(self, source: Reference) -> Reference:
        at = {self.prefix + axis: label for axis, label in source.at.items()}
        return replace(source, node=self.prefix + source.node, at=at)

    def _settings(self, settings: Mapping[str, Written]) -> dict[str, Written]:
        return {name: self._setting(written) for name, written in settings.items()}

    def _setting(self, written: Written) -> Written:
        written = replace(written, folder=written.folder or self.spec.folder)
        if isinstance(written.value, Variable):
            return self._resolved(written.value, written)
        return replace(written, value=with_leaves(written.value, self._substituted))

    def _substituted(self, value: object) -> object:
        if not isinstance(value, Variable):
            return value
        return self._resolved(value, Written(None, value.place)).value

    def _resolved(self, variable: Variable, written: Written) -> Written:
        """Return the value of a variable of the graph here, in place of `written`."""
        name = variable.name
        if name not in self.spec.inputs:
            return replace(written, value=replace(variable, name=self.prefix + name))
        default = replace(written, value=self.spec.inputs[name].value)
        source = self.settings.get(name) or default
        return replace(source, value=field_of(source.value, variable.field))
