"""The typed graph: nodes with their methods, settings and axes, and the wires between them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from nodegraph.errors import NodegraphError, Place, Problem, Problems, nearest, quoted
from nodegraph.graphfile.axes import FILE, axis_from_option, is_label, is_pattern
from nodegraph.graphfile.spec import Gathering, GraphSpec, Reference, ReportEntry
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Label
from nodegraph.node.values import Files
from nodegraph.plugin.registry import Registry

if TYPE_CHECKING:
    import networkx as nx


@dataclass(frozen=True)
class Choices:
    """The choices of the command or the caller: inputs, axes, and the labels to run.

    Attributes
    ----------
    inputs : mapping
        Input -> value.
    axes : mapping
        Axis -> a list of labels, or a mapping of labels to values, or a generator.
    only : mapping
        Axis, or node with alternatives -> the labels to run.
    folder : Path
        Where relative paths among them start.
    folders : mapping
        Input or axis -> where relative paths in its value start instead.
    """

    inputs: Mapping[str, object] = field(default_factory=dict)
    axes: Mapping[str, object] = field(default_factory=dict)
    only: Mapping[str, tuple[Label, ...]] = field(default_factory=dict)
    folder: Path = field(default_factory=Path.cwd)
    folders: Mapping[str, Path] = field(default_factory=dict)

    @property
    def listed(self) -> Choices:
        """The same choices, with a label for each file instead of patterns that match any."""
        axes = dict(self.axes)
        for name, value in self.axes.items():
            if is_pattern(value):
                folder = self.folders.get(name, self.folder)
                axis = axis_from_option(name, value, folder, Problems())
                axes[name] = dict(zip(axis.labels, axis.values, strict=True)) or value
        return replace(self, axes=axes)

    def updated(self, later: Choices) -> Choices:
        """Return these choices with later ones on top."""
        return Choices(
            {**self.inputs, **later.inputs},
            {**self.axes, **later.axes},
            {**self.only, **later.only},
            later.folder,
            {**self.folders, **later.folders},
        )


@dataclass(frozen=True)
class Axis:
    """One axis with the labels that are run.

    Attributes
    ----------
    labels : tuple of label
        In order.
    values : mapping of label to value
        The value that ``$axis`` stands for; empty for the axis of a node's alternatives.
    removed : frozenset of label
        Labels of the file that the choices leave out.
    """

    name: str
    labels: tuple[Label, ...]
    values: Mapping[Label, object] = field(default_factory=dict)
    removed: frozenset[Label] = frozenset()

    @cached_property
    def fields(self) -> Mapping[str, Mapping[Label, Label]]:
        """The fields that every label has, such as its actor, but for the file: field -> values."""
        fields: dict[str, dict[Label, Label]] = {}
        for label in self.labels:
            value = self.values.get(label)
            for name, each in value.items() if isinstance(value, dict) else ():
                if name != FILE and is_label(each):
                    fields.setdefault(str(name), {})[label] = each
        return {name: of for name, of in fields.items() if len(of) == len(self.labels)}


@dataclass(frozen=True)
class Gather:
    """The sources of a gathering port: a single one, or several with labels.

    Attributes
    ----------
    axis : str
        The axis of the labels, named after the port; empty for a single source.
    sources : mapping of label to Reference
        A single source has the empty label.
    """

    axis: str
    sources: Mapping[str, Reference]


def sources_of(feed: Reference | Gathering | Gather) -> tuple[Reference, ...]:
    """Return every reference that feeds a port."""
    return (feed,) if isinstance(feed, Reference) else tuple(feed.sources.values())


@dataclass(frozen=True)
class Settings:
    """The settings of a method for every combination of the axes that they depend on.

    Attributes
    ----------
    axes : tuple of str
    values : mapping of labels to settings
        Validated, with defaults, files resolved: what the function is called with.
    shown : mapping of labels to settings
        The same in the form in which they were written, defaults included.
    """

    axes: tuple[str, ...]
    values: Mapping[tuple[Label, ...], Mapping[str, Any]]
    shown: Mapping[tuple[Label, ...], Mapping[str, Any]]


@dataclass(frozen=True)
class Method:
    """One way to compute a node.

    Attributes
    ----------
    label : str
        Its label among the alternatives; empty where there are none.
    node : Node
    plugin, distribution : str
        Where the node comes from.
    inputs : mapping of port to Reference or Gather
    settings : Settings
    place : Place
    places : mapping of setting to Place
        Where each setting is written: in the file, or in the command.
    """

    label: str
    node: Node
    plugin: str
    distribution: str
    inputs: Mapping[str, Reference | Gather]
    settings: Settings
    place: Place
    places: Mapping[str, Place] = field(default_factory=dict)

    def references(self) -> Iterator[Reference]:
        """Yield every reference that feeds it."""
        for feed in self.inputs.values():
            yield from sources_of(feed)

    @property
    def gathers(self) -> tuple[Gather, ...]:
        """The references that feed its gathering ports."""
        return tuple(feed for feed in self.inputs.values() if isinstance(feed, Gather))


def method_name(node: str, label: str) -> str:
    """Return the name of a method in messages: ``fill (muscle)``; without a label, the node's."""
    return f"{node} ({label})" if label else node


@dataclass(frozen=True)
class GraphNode:
    """One node of the graph.

    Attributes
    ----------
    methods : mapping of label to Method
    has_alternatives : bool
        Whether the node's name is an axis of its own.
    axes : tuple of str
        The axes along which it has values.
    gathered : tuple of str
        The axes that its gathering ports gather.
    prefix : str
        For a node of a graph used as a node, what precedes the names in that graph.
    """

    name: str
    place: Place
    methods: Mapping[str, Method]
    has_alternatives: bool
    axes: tuple[str, ...]
    gathered: tuple[str, ...] = ()
    prefix: str = ""

    def local_name(self, axis: str) -> str:
        """Return the name of an axis in the graph file in which the node is written."""
        return axis.removeprefix(self.prefix)

    @property
    def first(self) -> Method:
        """Any of the methods: what they have in common can be read from it."""
        return next(iter(self.methods.values()))

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the outputs that every method has, in the order of the first method."""
        names = [[port.name for port in method.node.outputs] for method in self.methods.values()]
        return tuple(name for name in names[0] if all(name in other for other in names))


class Wire(NamedTuple):
    """One edge of the graph: a reference to an output, and the port that it feeds.

    Attributes
    ----------
    output : str
        The name of the output, also where the reference leaves it out.
    port : str
    reference : Reference
        As written, with its place and the axes that it fixes.
    gathers : bool
        Whether the port is a gathering one.
    """

    output: str
    port: str
    reference: Reference
    gathers: bool


@dataclass(frozen=True)
class LeftOut:
    """A node that is left out because a label that it needs is not run."""

    node: str
    reason: str


@dataclass(frozen=True)
class Graph:
    """A valid graph.

    Attributes
    ----------
    spec : GraphSpec
    registry : Registry
        Where its nodes, and the way in which values are shown, come from.
    network : networkx.MultiDiGraph
        Nodes and wires, frozen. Nodes come in an order in which each follows those that feed it;
        the attribute ``record`` of a node is its `GraphNode`. An edge leads from a node to a
        reader of it, one per reference; its attribute ``record`` is its `Wire`.
    axes : mapping of name to Axis
    inputs : mapping of name to value
        As in the file or as chosen.
    choices : Choices
    left_out : tuple of LeftOut
    notices : tuple of Problem
        Uses of what is deprecated, and methods that look ahead before samples are hidden.

    Examples
    --------
    >>> graph = nodegraph.load("graphs/fill.yaml")
    >>> networkx.ancestors(graph.network, "fill")
    {'capture', 'gaps'}
    >>> [(wire.output, wire.port) for *_, wire in graph.network.in_edges("error", data="record")]
    [('output', 'estimate'), ('truth', 'truth'), ('hidden', 'hidden')]
    """

    spec: GraphSpec
    registry: Registry
    network: nx.MultiDiGraph[str]
    axes: Mapping[str, Axis]
    inputs: Mapping[str, object]
    choices: Choices
    left_out: tuple[LeftOut, ...] = ()
    notices: tuple[Problem, ...] = ()

    def __repr__(self) -> str:
        axes = ", ".join(f"{name} ({len(axis.labels)})" for name, axis in self.axes.items())
        return f"<Graph of {len(self.nodes)} nodes{' along ' if axes else ''}{axes}>"

    def __getitem__(self, name: str) -> NoReturn:
        """Refuse, as a graph has no values; a run has."""
        raise TypeError(
            f"a graph has no values: nodegraph.run(graph)[{quoted(name)}] has them; "
            f"graph.nodes[{quoted(name)}] describes the node"
        )

    @cached_property
    def nodes(self) -> Mapping[str, GraphNode]:
        """The nodes by name, each after those that feed it."""
        return {name: data["record"] for name, data in self.network.nodes.items()}

    def wires(self) -> Iterator[tuple[str, str, Wire]]:
        """Yield every wire with the node that is read and its reader, reader by reader."""
        for source, target, edge in self.network.in_edges(data=True):
            yield source, target, edge["record"]

    def sources(self, name: str) -> frozenset[str]:
        """Return the nodes without inputs that a node is computed from; itself, if it is one."""
        import networkx as nx

        needed = nx.ancestors(self.network, name) | {name}
        return frozenset(node for node in needed if not self.network.in_degree(node))

    def source_axes(self, name: str) -> frozenset[str]:
        """Return the axes on which the sources of a node depend: along them the data differ.

        They are those of the settings of its sources, and sources that are axes themselves, since
        they have alternatives. Along any other axis, the same data are treated in several ways.

        Examples
        --------
        >>> graph.source_axes("error")
        frozenset({'actor'})
        """
        sources = [self.nodes[source] for source in self.sources(name)]
        return frozenset(axis for source in sources for axis in source.axes)

    @property
    def title(self) -> str:
        """The title of the file, or its name."""
        return self.spec.title or self.spec.file

    def reasons_left_out(self) -> dict[str, str]:
        """Return why nodes are left out, by node."""
        return {item.node: item.reason for item in self.left_out}

    def left_out_together(self) -> dict[str, tuple[str, ...]]:
        """Return which nodes are left out, by the reason that they have in common."""
        together: dict[str, tuple[str, ...]] = {}
        for node, reason in self.reasons_left_out().items():
            together[reason] = (*together.get(reason, ()), node)
        return together

    @cached_property
    def reported(self) -> tuple[tuple[str, str], ...]:
        """The nodes, and ports, that the report shows: as listed, else nodes that nothing reads.

        Outputs that are files come last in any case.
        """
        listed = dict.fromkeys((entry.node, entry.port) for entry in self.spec.report)
        shown = listed or dict.fromkeys(
            (name, "") for name, readers in self.network.out_degree() if not readers
        )
        files = (
            (name, port)
            for name, node in self.nodes.items()
            for port in _file_outputs(node)
            if (name, "") not in shown
        )
        entries = dict.fromkeys((*shown, *files))
        return tuple(entry for entry in entries if entry[0] in self.nodes)

    def report_entry(self, node: str, port: str, labels: Mapping[str, Label]) -> ReportEntry | None:
        """Return the entry under which the report shows one of `reported` at these labels.

        Entries may fix axes: None where no entry has these labels. What is shown without being
        listed has an entry without title and caption.
        """
        entries = [
            entry for entry in self.spec.report if (entry.node, entry.port) == (node, port)
        ] or [ReportEntry(node, port, self.nodes[node].place)]
        return next((entry for entry in entries if entry.at.items() <= labels.items()), None)

    def until(self, names: Iterable[str]) -> Graph:
        """Return the graph of these nodes and all that they need; its report shows these nodes.

        Raises
        ------
        NodegraphError
            If the graph lacks one of them.
        """
        import networkx as nx

        targets = tuple(dict.fromkeys(names))
        needed = set(targets)
        for name in targets:
            if name not in self.nodes:
                hint = nearest(name, self.nodes)
                raise NodegraphError(f"the graph has no node {quoted(name)}; {hint}")
            needed |= nx.ancestors(self.network, name)
        network = self.network.copy()  # unlike a subgraph view, it keeps the order of the nodes
        network.remove_nodes_from(self.nodes.keys() - needed)
        report = tuple(ReportEntry(name, "", self.nodes[name].place) for name in targets)
        return replace(self, network=nx.freeze(network), spec=replace(self.spec, report=report))

    def output_name(self, source: Reference) -> str:
        """Return the name of the output that a reference means."""
        return source.port or self.nodes[source.node].first.node.outputs[0].name


def _file_outputs(node: GraphNode) -> Iterator[str]:
    """Yield the outputs that are files; an empty name if the node has no other output."""
    outputs = node.first.node.outputs
    return (
        port.name if len(outputs) > 1 else "" for port in outputs if issubclass(port.type, Files)
    )
