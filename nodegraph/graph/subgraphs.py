"""Graphs used as nodes: each is checked by itself, once, and put in the place of the node.

A graph file is checked as it stands, with something of the declared type behind each of its ports.
What is wrong inside is so told once, with the names that it has there; whoever uses the file only
has to fit its ports, settings and outputs.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.builder import Builder
from nodegraph.graph.choices import Choices
from nodegraph.graph.methods import shared_and_own
from nodegraph.graph.model import (
    Feed,
    Flat,
    Gather,
    Graph,
    HandsOn,
    graph_node,
    port_node,
    sources_of,
)
from nodegraph.graph.settings import columns_of
from nodegraph.graph.wiring import labelled
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
)
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered, Registry


@dataclass(frozen=True)
class Subgraph:
    """A graph file as whoever uses it sees it.

    Attributes
    ----------
    spec : GraphSpec
        Flat, and only what leads to its outputs: what is put in the place of a node.
    graphs : mapping of node to (mapping of label to Registered)
        What stands in it for the graphs that its own nodes use.
    asks : mapping of name to Port
        Its inputs that are ports. One takes the truth if everything that reads it does, and
        gathers if everything that reads it does.
    outputs : mapping of name to Port
    is_whole : bool
        Whether no mistake was found in it; else nothing is known of its outputs.
    """

    spec: GraphSpec
    graphs: Mapping[str, Mapping[str, Registered]]
    asks: Mapping[str, Port]
    outputs: Mapping[str, Port]
    is_whole: bool


def broken(flat: Flat) -> Subgraph:
    """Return what is known of a graph in which there are mistakes."""
    asks = {name: replace(one, truth=True, across=True) for name, one in flat.ports.items()}
    return Subgraph(_with_settings_only(flat, flat.spec), {}, asks, {}, is_whole=False)


def subgraph_of(flat: Flat, graph: Graph, problems: Problems) -> Subgraph:
    """Return what whoever uses a graph has to know; note what keeps it from being used."""
    asks = {name: _asked(port, graph) for name, port in flat.ports.items()}
    outputs = {
        name: _output(name, source, graph, asks, problems)
        for name, source in flat.spec.outputs.items()
    }
    for known in flat.spec.known:
        if known.node.startswith("$"):
            message = f"known: {known} comes from outside; only the graph that gives it can say so"
            problems.add(known.place, message)
    kept = _leading_to(flat.spec.outputs, graph)
    nodes = {name: one for name, one in flat.spec.nodes.items() if name in kept}
    axes = {
        name for one in kept for m in graph.nodes[one].methods.values() for name in m.settings.axes
    }
    spec = replace(
        _with_settings_only(flat, flat.spec),
        nodes=nodes,
        axes={name: one for name, one in flat.spec.axes.items() if name in axes},
        skip=tuple(
            item
            for item in flat.spec.skip
            if any(item.labels.keys() <= set(graph.nodes[one].axes) for one in kept)
        ),
        known=tuple(one for one in flat.spec.known if one.node in kept),
    )
    graphs = {name: one for name, one in flat.graphs.items() if name in kept}
    return Subgraph(spec, graphs, asks, outputs, is_whole=not problems)


def _with_settings_only(flat: Flat, spec: GraphSpec) -> GraphSpec:
    inputs = {name: one for name, one in spec.inputs.items() if name not in flat.ports}
    return replace(spec, inputs=inputs)


def _asked(port: Port, graph: Graph) -> Port:
    readers = list(_readers(f"${port.name}", graph))
    return replace(
        port,
        truth=bool(readers) and all(one.truth for one, _ in readers),
        across=bool(readers) and all(alone and one.across for one, alone in readers),
    )


def _readers(name: str, graph: Graph) -> Iterator[tuple[Port, bool]]:
    """Yield the ports that a node feeds, and whether it is all that feeds them."""
    for node in graph.nodes.values():
        for method in node.methods.values():
            for port, fed in method.inputs.items():
                found = method.node.port(port)
                if found is not None and name in {one.node for one in sources_of(fed)}:
                    yield found, not (isinstance(fed, Gather) and fed.axis)


def _output(
    name: str,
    source: Reference,
    graph: Graph,
    asks: Mapping[str, Port],
    problems: Problems,
) -> Port:
    """Return an output as a port, of the type that fits whatever comes out there."""
    if source.node.startswith("$"):
        return replace(asks[source.node[1:]], name=name, across=False)
    if name in graph.nodes and not _is_node_itself(name, source, graph):
        message = f"output {name!r} is not the node of that name"
        problems.add(source.place, message, "outside, both would have one name; rename the output")
    methods = graph.nodes[source.node].methods.values()
    found = [(one.node, one.node.output(source.port) or one.node.outputs[0]) for one in methods]
    ports = [port for _, port in found]
    widest = [one for one in ports if all(issubclass(other.type, one.type) for other in ports)]
    if not widest:
        types = ", ".join(f"{port.type.__name__} ({node.name})" for node, port in found)
        problems.add(source.place, f"output {name!r} has no one type: {types}")
    kind = (widest or ports)[0].type
    return Port(name, kind, truth=any(one.truth for one in ports), columns=columns_of(ports))


def _is_node_itself(name: str, source: Reference, graph: Graph) -> bool:
    if source.node != name or source.at:
        return False
    methods = graph.nodes[name].methods.values()
    return all(one.node.outputs[0].name == source.port for one in methods) or not source.port


def _leading_to(outputs: Mapping[str, Reference], graph: Graph) -> set[str]:
    """Return the nodes that lead to outputs, without what stands for ports."""
    found: set[str] = set()
    pending = [source.node for source in outputs.values()]
    while pending:
        name = pending.pop()
        if name not in found and not name.startswith("$"):
            found.add(name)
            methods = graph.nodes[name].methods.values()
            feeds = (fed for one in methods for fed in one.inputs.values())
            pending.extend(source.node for fed in feeds for source in sources_of(fed))
    return found


MOST_VALUES = 100_000
MOST_DEPTH = 100


@dataclass(frozen=True)
class Placed:
    """A graph where a node uses it.

    Attributes
    ----------
    prefix : str
        Comes before the names of its nodes and axes: ``clean.``.
    spec : GraphSpec
        The graph, flat; only what is to be put in place.
    wiring : mapping of port to Reference or Gathering
        What feeds its ports.
    settings : mapping of input to Written
        What its other inputs are given.
    """

    prefix: str
    spec: GraphSpec
    wiring: Mapping[str, Reference | Gathering]
    settings: Mapping[str, Written]

    def nodes(self) -> Iterator[NodeSpec]:
        """Yield its nodes."""
        for node in self.spec.nodes.values():
            yield replace(
                node,
                name=self.prefix + node.name,
                methods=tuple(map(self._method, node.methods)),
                wiring=self.fed(node.wiring),
                settings=self._given(node.settings),
                over=node.over and tuple((self.prefix + axis, at) for axis, at in node.over),
                prefix=self.prefix + node.prefix,
            )

    def axes(self) -> Iterator[AxisSpec]:
        """Yield its axes."""
        for axis in self.spec.axes.values():
            folder = axis.folder or self.spec.folder
            yield replace(axis, name=self.prefix + axis.name, folder=folder)

    def skip(self) -> Iterator[SkipSpec]:
        """Yield the combinations that it leaves out."""
        for item in self.spec.skip:
            yield replace(item, labels={self.prefix + k: one for k, one in item.labels.items()})

    def known(self) -> Iterator[Reference]:
        """Yield what its methods may know."""
        return (self._renamed(one) for one in self.spec.known)

    def fed(self, wiring: Wiring) -> Wiring:
        """Return wires between its nodes, with those that come in from outside."""
        return {port: self._source(fed) for port, fed in wiring.items()}

    def _method(self, method: MethodSpec) -> MethodSpec:
        if not method.wiring and not method.settings:
            return method
        wiring, settings = self.fed(method.wiring), self._given(method.settings)
        return replace(method, wiring=wiring, settings=settings)

    def _source(self, fed: Reference | Gathering) -> Reference | Gathering:
        if isinstance(fed, Gathering):
            sources = {label: self._one(source) for label, source in fed.sources.items()}
            return Gathering(sources, fed.place)
        return self._from_outside(fed) if fed.node.startswith("$") else self._renamed(fed)

    def _one(self, source: Reference) -> Reference:
        found = self._source(source)
        assert isinstance(found, Reference), "a port that feeds one of several takes one value"
        return found

    def _from_outside(self, source: Reference) -> Reference | Gathering:
        found = self.wiring[source.node[1:]]
        if isinstance(found, Reference):
            return replace(found, passed=True)
        passed = {label: replace(one, passed=True) for label, one in found.sources.items()}
        return Gathering(passed, found.place)

    def _renamed(self, source: Reference) -> Reference:
        at = {self.prefix + axis: label for axis, label in source.at.items()}
        return replace(source, node=self.prefix + source.node, at=at)

    def _given(self, settings: Mapping[str, Written]) -> dict[str, Written]:
        return {name: self._written(one) for name, one in settings.items()}

    def _written(self, written: Written) -> Written:
        folder = written.folder or self.spec.folder
        if isinstance(written.value, Variable):
            return self._stands_for(written.value, replace(written, folder=folder))
        return replace(written, value=self._replaced(written.value), folder=folder)

    def _replaced(self, value: Any) -> Any:
        if isinstance(value, Variable):
            return self._stands_for(value, Written(None, value.place)).value
        if isinstance(value, dict):
            return {key: self._replaced(one) for key, one in value.items()}
        if isinstance(value, list):
            return [self._replaced(one) for one in value]
        return value

    def _stands_for(self, variable: Variable, written: Written) -> Written:
        """Return what a variable of the graph stands for here."""
        name = variable.name
        if name not in self.spec.inputs:
            return replace(written, value=replace(variable, name=self.prefix + name))
        given = self.settings.get(name) or replace(written, value=self.spec.inputs[name].value)
        return replace(given, value=field_of(given.value, variable.field))


def field_of(value: Any, name: str) -> Any:
    """Return one field of a value, which may stand for another.

    Raises
    ------
    KeyError
        If it has no such field.
    """
    if not name:
        return value
    if isinstance(value, Variable) and not value.field:
        return replace(value, field=name)
    if isinstance(value, dict):
        return value[name]
    raise KeyError(name)


def written_in(nodes: Iterable[NodeSpec]) -> Iterator[Written]:
    """Yield every setting of nodes and of their methods."""
    for node in nodes:
        yield from node.settings.values()
        for method in node.methods:
            yield from method.settings.values()


def unfolds_too_far(spec: GraphSpec, settings: Mapping[str, Written]) -> bool:
    """Whether a graph's settings become endless with these in them: what holds one twice doubles.

    Each graph of a chain of graphs may double what it is given before it hands it on.
    """
    extents = {name: _extent(one.value) for name, one in settings.items()}
    total = 0
    for written in written_in(spec.nodes.values()):
        size, depth = _extent(written.value)
        put_in = [extents[one.name] for one in written.variables() if one.name in extents]
        depth += max((deeper for _, deeper in put_in), default=0)
        total += size + sum(more for more, _ in put_in)
        if total > MOST_VALUES or depth > MOST_DEPTH:
            return True
    return False


def _extent(value: Any) -> tuple[int, int]:
    """Return how many values there are in one, and how deep they lie."""
    size = depth = 0
    pending = [(value, 0)]
    while pending:
        one, level = pending.pop()
        size, depth = size + 1, max(depth, level)
        if isinstance(one, (dict, list)):
            items = one.values() if isinstance(one, dict) else one
            pending.extend((item, level + 1) for item in items)
    return size, depth


@dataclass(frozen=True)
class Use:
    """A node, or one of its alternatives, that uses a graph.

    Attributes
    ----------
    node : NodeSpec
    method : MethodSpec
    graph : Subgraph
    """

    node: NodeSpec
    method: MethodSpec
    graph: Subgraph

    @property
    def where(self) -> str:
        """What it is called in messages."""
        label = self.method.label
        return f"{self.node.name} ({label})" if label else self.node.name

    @property
    def prefix(self) -> str:
        """What comes before the names of nodes and axes inside."""
        label = self.method.label
        return f"{self.node.name}.{label}." if label else f"{self.node.name}."

    @property
    def wiring(self) -> Wiring:
        """What feeds the graph's ports; shared wires included."""
        return shared_and_own(self.node, self.method, self.stand_in(*self.graph.outputs))

    @property
    def settings(self) -> Mapping[str, Written]:
        """What the graph's other inputs are given; shared settings included."""
        return {**self.node.settings, **self.method.settings}

    def stand_in(self, *outputs: str) -> HandsOn:
        """Return what hands on some of the graph's outputs."""
        ports = tuple(self.graph.outputs[name] for name in outputs)
        asks = tuple(self.graph.asks.values())
        offers = tuple(self.graph.outputs)
        return graph_node(self.method.use, self.graph.spec.title, asks, ports, offers)


def fits(use: Use, problems: Problems) -> bool:
    """Whether a graph can be put in the place of what uses it; note why not."""
    found = Problems()
    _Check(use, found).check()
    for one in found.all():
        problems.add(one.place, one.message, one.instead)
    return use.graph.is_whole and not found


class _Check:
    def __init__(self, use: Use, problems: Problems) -> None:
        self._use = use
        self._graph = use.graph
        self._name = use.method.use
        self._problems = problems

    def check(self) -> None:
        if not self._graph.spec.outputs:
            message = f"{self._use.where}: {self._name} has no 'outputs': nothing comes out of it"
            self._problems.add(
                self._use.method.place, message, "write there: outputs: {name: node}"
            )
        for name, fed in self._use.wiring.items():
            self._check_port(name, fed)
        self._check_open_ports()
        for name, written in self._use.settings.items():
            self._check_setting(name, written)
        if self._graph.is_whole:
            self._check_effects()
            self._check_fields()
            self._check_extent()

    def _check_port(self, name: str, fed: Reference | Gathering) -> None:
        port = self._graph.asks.get(name)
        if port is None:
            what = f"no input port {name!r}" if name else "no input port"
            hint = nearest(name, self._graph.asks, what="ports")
            if name in self._graph.spec.inputs:
                hint = f"it is a setting: with: {{{name}: value}}"
            self._note(fed.place, f"{self._name} has {what}", hint)
        elif isinstance(fed, Gathering) and not port.across:
            message = f"port {name!r} takes one value, not a mapping of several"
            self._note(fed.place, message, f"inside, ${name} feeds ports that do not gather")

    def _check_open_ports(self) -> None:
        for name, port in self._graph.asks.items():
            if name not in self._use.wiring:
                message = f"port {name}: {port.type.__name__} of {self._name} is not fed"
                self._note(self._use.method.place, message, f"write in: {{{name}: node}}")

    def _check_setting(self, name: str, written: Written) -> None:
        if name in self._graph.spec.inputs:
            return
        hint = nearest(name, self._graph.spec.inputs, what="settings")
        if name in self._graph.asks:
            hint = f"it is a port: in: {{{name}: node}}"
        self._note(written.place, f"{self._name} has no setting {name!r}", hint)

    def _check_effects(self) -> None:
        read = {one.name for one in self._read}
        for name, written in self._use.settings.items():
            if name in self._graph.spec.inputs and name not in read:
                message = f"setting {name!r} of {self._name} leads to none of its outputs"
                self._note(written.place, message, "leave it out: it would change nothing")

    def _check_fields(self) -> None:
        """Check that what is given has the fields that are taken of it inside."""
        for variable in (one for one in self._read if one.name in self._use.settings):
            given = self._use.settings[variable.name]
            try:
                field_of(given.value, variable.field)
            except KeyError:
                fields = list(given.value) if isinstance(given.value, dict) else []
                message = f"setting {variable.name!r} of {self._name} needs {variable.field!r}"
                self._note(given.place, message, nearest(variable.field, fields, what="fields"))

    def _check_extent(self) -> None:
        if unfolds_too_far(self._graph.spec, self._use.settings):
            message = f"with these settings, those inside {self._name} become endless"
            instead = "each of several graphs puts what it is given into a list or mapping again"
            self._note(self._use.method.place, message, instead)

    @cached_property
    def _read(self) -> list[Variable]:
        """The inputs that are read inside."""
        inside = written_in(self._graph.spec.nodes.values())
        return list(dict.fromkeys(one for written in inside for one in written.variables()))

    def _note(self, place: Place, message: str, instead: str) -> None:
        self._problems.add(place, f"{self._use.where}: {message}", instead)


class Unfolding:
    """Puts the graphs that the nodes of one graph use in the place of these nodes.

    Parameters
    ----------
    spec
    ports
        Its inputs that are ports.
    find
        Returns the checked graph of a file.
    problems
        Where mistakes in the use of graphs are noted.
    """

    def __init__(
        self,
        spec: GraphSpec,
        ports: Mapping[str, Port],
        find: Callable[[Path], Subgraph],
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
        self._graphs: dict[str, dict[str, Registered]] = {}
        self._feeds: list[Feed] = []
        self._given: list[Written] = []
        self._uses = dict(self._found(find))
        self._fitting = {at for at, use in self._uses.items() if fits(use, problems)}

    def flat(self) -> Flat:
        """Return the graph with everything in its place."""
        for name, port in self._ports.items():
            self._stand(f"${name}", port_node(port), self._spec.inputs[name].place, {})
        for node in self._spec.nodes.values():
            methods = tuple(self._method(node, one) for one in node.methods)
            self._nodes[node.name] = replace(node, methods=methods, wiring=self._led(node.wiring))
        outputs = self._spec.outputs.items()
        spec = replace(
            self._spec,
            nodes=self._nodes,
            axes=self._axes,
            skip=tuple(self._skip),
            known=(*self._all_led(self._spec.known), *self._known),
            requires=tuple(self._requires),
            outputs={name: self._one_led(one) for name, one in outputs},
            report=tuple(self._all_led(self._spec.report)),
            written=self._spec,
        )
        is_whole = len(self._fitting) == sum(1 for _ in self._graph_methods())
        feeds, given = tuple(self._feeds), tuple(self._given)
        return Flat(spec, self._ports, self._graphs, feeds, given, is_whole)

    def _graph_methods(self) -> Iterator[tuple[NodeSpec, MethodSpec]]:
        for node in self._spec.nodes.values():
            yield from ((node, one) for one in node.methods if one.is_graph)

    def _found(self, find: Callable[[Path], Subgraph]) -> Iterator[tuple[tuple[str, str], Use]]:
        for node, method in self._graph_methods():
            path = self._spec.uses.get(method.use)
            if path is not None:
                yield (node.name, method.label), Use(node, method, find(path))

    def _method(self, node: NodeSpec, method: MethodSpec) -> MethodSpec:
        """Return a method with its graph, if it uses one, put in place."""
        if not method.is_graph:
            return replace(method, wiring=self._led(method.wiring))
        use = self._uses.get((node.name, method.label))
        if use is not None:
            self._given.extend(use.settings.values())
            self._feed(use)
        if use is None or (node.name, method.label) not in self._fitting:
            return replace(method, use="", wiring=self._led(method.wiring))
        placed = Placed(use.prefix, use.graph.spec, self._led(use.wiring), use.settings)
        self._put(placed, use)
        outputs = placed.fed(use.graph.spec.outputs)
        handed = outputs if node.has_alternatives else self._parted(use, outputs)
        made = Registered(use.stand_in(*handed), "nodegraph")
        self._graphs.setdefault(node.name, {})[method.label] = made
        return replace(method, wiring=handed, settings={})

    def _parted(self, use: Use, outputs: Wiring) -> Wiring:
        """Give all outputs but the first nodes of their own, where they are none; return that."""
        first, *others = outputs
        for name in others:
            if name not in use.graph.spec.nodes:
                stand_in, wiring = use.stand_in(name), {name: outputs[name]}
                self._stand(use.prefix + name, stand_in, use.node.place, wiring)
        return {first: outputs[first]}

    def _stand(self, name: str, node: HandsOn, place: Place, wiring: Wiring) -> None:
        method = MethodSpec("", node.name, place, wiring)
        self._nodes[name] = NodeSpec(name, place, (method,), False, {}, {}, None)
        self._graphs[name] = {"": Registered(node, "nodegraph")}

    def _put(self, placed: Placed, use: Use) -> None:
        for inner in placed.nodes():
            if inner.name in self._nodes:
                message = f"two nodes would be called {inner.name!r}"
                instead = f"rename the label {use.method.label!r}"
                self._problems.add(use.method.place, message, instead)
            self._nodes[inner.name] = inner
        self._axes |= {axis.name: axis for axis in placed.axes()}
        self._skip.extend(placed.skip())
        self._known.extend(placed.known())
        self._requires |= dict.fromkeys(use.graph.spec.requires)
        for name, graphs in use.graph.graphs.items():
            self._graphs[placed.prefix + name] = dict(graphs)

    def _feed(self, use: Use) -> None:
        for name, fed in self._led(use.wiring).items():
            port = use.graph.asks.get(name)
            self._feeds += [Feed(use.where, port, source) for _, source in labelled(fed)]

    def _led(self, wiring: Wiring) -> Wiring:
        """Return wires that lead to the nodes that hand on outputs of graphs."""
        if not self._fitting:
            return wiring
        return {
            port: Gathering({k: self._one_led(one) for k, one in fed.sources.items()}, fed.place)
            if isinstance(fed, Gathering)
            else self._one_led(fed)
            for port, fed in wiring.items()
        }

    def _one_led(self, source: Reference) -> Reference:
        if (source.node, "") not in self._fitting:
            return source
        use = self._uses[source.node, ""]
        _, *others = use.graph.outputs
        if source.port in others:
            return replace(source, node=use.prefix + source.port, port="")
        return source

    def _all_led(self, references: Iterable[Reference]) -> Iterator[Reference]:
        """Yield references to nodes; one to a node that uses a graph means all its outputs."""
        for one in references:
            ports = [one.port]
            if not one.port and (one.node, "") in self._fitting:
                ports = ["", *list(self._uses[one.node, ""].graph.outputs)[1:]]
            yield from (self._one_led(replace(one, port=port)) for port in ports)


class Subgraphs:
    """The graph files that a graph uses.

    Parameters
    ----------
    specs
    registry
    problems
        Where mistakes in these files are noted.
    """

    def __init__(
        self, specs: Mapping[Path, GraphSpec], registry: Registry, problems: Problems
    ) -> None:
        self._specs = specs
        self._registry = registry
        self._problems = problems
        self._checked: dict[Path, Subgraph] = {}

    def flat(self, spec: GraphSpec, problems: Problems) -> Flat:
        """Return a graph with the nodes of the graphs that it uses in their place."""
        ports = dict(self._ports(spec, problems))
        uses_graphs = any(one.is_graph for node in spec.nodes.values() for one in node.methods)
        if not ports and not uses_graphs:
            return Flat(spec, {}, {}, (), (), is_whole=True)
        return Unfolding(spec, ports, self.checked, problems).flat()

    def checked(self, path: Path) -> Subgraph:
        """Return the graph of a file, which is checked when it is asked for first."""
        if path not in self._checked:
            self._checked[path] = self._check(self._specs[path])
        return self._checked[path]

    def _check(self, spec: GraphSpec) -> Subgraph:
        problems = Problems(spec.problems)
        flat = self.flat(spec, problems)
        graph = Builder(flat, self._registry, Choices(), problems).build()
        made = broken(flat)
        if flat.is_whole and not problems:
            made = subgraph_of(flat, graph, problems)
        for one in problems.all():
            self._problems.add(one.place, one.message, one.instead)
        return made

    def _ports(self, spec: GraphSpec, problems: Problems) -> Iterator[tuple[str, Port]]:
        """Yield the inputs whose value is the name of a port's type."""
        for name, one in spec.inputs.items():
            if not isinstance(one.value, str) or not one.value.isidentifier():
                continue
            types = self._types.get(one.value, {})
            if len(types) > 1:
                where = " and ".join(sorted(f"{kind.__module__}.{one.value}" for kind in types))
                problems.add(one.place, f"{one.value!r} is the name of several types: {where}")
            if types:
                yield name, Port(name, next(iter(types)))

    @cached_property
    def _types(self) -> Mapping[str, dict[type, None]]:
        """The types of all ports of installed nodes, by name."""
        found: dict[str, dict[type, None]] = defaultdict(dict)
        for registered in self._registry:
            for port in (*registered.node.inputs, *registered.node.outputs):
                found[port.type.__name__][port.type] = None
        return found
