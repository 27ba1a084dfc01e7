"""The typed graph: every node with its methods, what feeds them, and the axes it has."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError, Place, Problem, nearest
from nodegraph.formatting import in_notebook
from nodegraph.graphfile.spec import GraphSpec, Reference, Written
from nodegraph.node.decorator import Node, Setting
from nodegraph.node.ports import Label, Port
from nodegraph.node.values import Files
from nodegraph.plugin.registry import Registered

if TYPE_CHECKING:
    import networkx as nx

    from nodegraph.graph.choices import Choices
    from nodegraph.graphfile import GraphSpec
    from nodegraph.plugin.registry import Registry


@dataclass(frozen=True)
class Axis:
    """One axis as it will be run.

    Attributes
    ----------
    labels : tuple of label
        Those that are run, in order.
    values : mapping of label to value
        What ``$axis`` stands for; empty for the axis of a node's alternatives.
    removed : frozenset of label
        Labels of the file that the command has taken away.
    """

    name: str
    labels: tuple[Label, ...]
    values: Mapping[Label, Any] = field(default_factory=dict)
    removed: frozenset[Label] = frozenset()


@dataclass(frozen=True)
class Gather:
    """What a gathering port takes: one source, or labelled ones along an axis of their own.

    Attributes
    ----------
    axis : str
        The port's name where the sources are labelled, else empty.
    sources : mapping of label to Reference
        The one source of an unlabelled gathering has the empty label.
    """

    axis: str
    sources: Mapping[str, Reference]


@dataclass(frozen=True)
class Settings:
    """The settings of a method for every combination of the axes that they depend on.

    Attributes
    ----------
    axes : tuple of str
    values : mapping of labels to settings
        Checked, with defaults, files resolved: what the function is called with.
    shown : mapping of labels to settings
        The same as a reader wrote them, defaults included.
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
        Who brought it.
    inputs : mapping of port to Reference or Gather
    settings : Settings
    place : Place
    places : mapping of setting to Place
        Where those that are given were written, or chosen.
    """

    label: str
    node: Node
    plugin: str
    distribution: str
    inputs: Mapping[str, Reference | Gather]
    settings: Settings
    place: Place
    places: Mapping[str, Place] = field(default_factory=dict)


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
        The axes that its gathering ports take together.
    prefix : str
        For a node of a graph used as a node, what comes before the names in that graph.
    """

    name: str
    place: Place
    methods: Mapping[str, Method]
    has_alternatives: bool
    axes: tuple[str, ...]
    gathered: tuple[str, ...] = ()
    prefix: str = ""

    def inside(self, axis: str) -> str:
        """Return what an axis is called in the graph file that the node stands in."""
        return axis.removeprefix(self.prefix)

    @property
    def first(self) -> Method:
        """Any of the methods: what they have in common can be read from it."""
        return next(iter(self.methods.values()))

    @property
    def outputs(self) -> tuple[str, ...]:
        """The names of the outputs that every method has, in the order of the first method."""
        others = [{port.name for port in one.node.outputs} for one in self.methods.values()]
        names = (port.name for port in self.first.node.outputs)
        return tuple(name for name in names if all(name in there for there in others))


@dataclass(frozen=True)
class LeftOut:
    """A node, or one source of a gathering port, that the command has left without a label."""

    node: str
    reason: str


@dataclass(frozen=True)
class Graph:
    """A graph in which every check has been made.

    Attributes
    ----------
    spec : GraphSpec
    registry : Registry
        Where its nodes, and how their values appear, come from.
    axes : mapping of name to Axis
    nodes : mapping of name to GraphNode
        In an order in which each comes after what feeds it.
    inputs : mapping of name to value
        With what the command has set.
    choices : Choices
        What the command or the caller has chosen.
    left_out : tuple of LeftOut
    notices : tuple of Problem
        What it uses that is deprecated, and where.
    """

    spec: GraphSpec
    registry: Registry
    axes: Mapping[str, Axis]
    nodes: Mapping[str, GraphNode]
    inputs: Mapping[str, Any]
    choices: Choices
    left_out: tuple[LeftOut, ...] = ()
    notices: tuple[Problem, ...] = ()

    @property
    def title(self) -> str:
        """The title of the file, or its name."""
        return self.spec.title or self.spec.file

    def reasons_left_out(self) -> dict[str, str]:
        """Return why nodes are left out, by node."""
        reasons: dict[str, dict[str, None]] = {}
        for entry in self.left_out:
            reasons.setdefault(entry.node, {})[entry.reason] = None
        return {node: "; ".join(several) for node, several in reasons.items()}

    def left_out_together(self) -> dict[str, tuple[str, ...]]:
        """Return which nodes are left out, by the reason that they have in common."""
        together: dict[str, tuple[str, ...]] = {}
        for node, reason in self.reasons_left_out().items():
            together[reason] = (*together.get(reason, ()), node)
        return together

    @cached_property
    def network(self) -> nx.MultiDiGraph[str]:
        """The typed graph itself: an edge per wire, keyed by source and target port."""
        import networkx as nx

        network: nx.MultiDiGraph[str] = nx.MultiDiGraph()
        for node in self.nodes.values():
            network.add_node(node.name, node=node)
        for target, port, source, gathers in self.wires():
            key = f"{source.port}->{port}"
            network.add_edge(source.node, target, key, source=source, port=port, gathers=gathers)
        return network

    @property
    def reported(self) -> tuple[tuple[str, str], ...]:
        """The nodes, and ports, that the report shows: as listed, else nodes that nothing reads.

        Those that make files come last in any case.
        """
        read = {source.node for _, _, source, _ in self.wires()}
        listed = dict.fromkeys((one.node, one.port) for one in self.spec.report)
        shown = listed or dict.fromkeys((name, "") for name in self.nodes if name not in read)
        files = (
            (name, port)
            for name, node in self.nodes.items()
            for port in _files(node)
            if (name, "") not in shown
        )
        return tuple(one for one in dict.fromkeys((*shown, *files)) if one[0] in self.nodes)

    def _repr_html_(self) -> str:
        """Return how a notebook shows the graph."""
        return in_notebook("graph_html", self)

    def output_name(self, source: Reference) -> str:
        """Return the name of the output that a reference means."""
        return source.port or self.nodes[source.node].first.node.outputs[0].name

    def wires(self) -> tuple[tuple[str, str, Reference, bool], ...]:
        """Return every wire once: target node, its port, the source, whether it gathers."""
        found: dict[tuple[str, str, str, str], tuple[str, str, Reference, bool]] = {}
        for node in self.nodes.values():
            for method in node.methods.values():
                for port, fed in method.inputs.items():
                    for source in sources_of(fed):
                        wire = (node.name, port, source, isinstance(fed, Gather))
                        found.setdefault((node.name, port, source.node, source.port), wire)
        return tuple(found.values())


def sources_of(fed: Reference | Gather) -> tuple[Reference, ...]:
    """Return the sources of whatever feeds a port."""
    return tuple(fed.sources.values()) if isinstance(fed, Gather) else (fed,)


def _files(node: GraphNode) -> Iterator[str]:
    """Return the outputs by which a node gives files; an empty name where it is the only one."""
    outputs = node.first.node.outputs
    return (
        port.name if len(outputs) > 1 else "" for port in outputs if issubclass(port.type, Files)
    )


def until(graph: Graph, names: Iterable[str]) -> Graph:
    """Return the graph with these nodes and all that they need; these are what it reports.

    Raises
    ------
    NodegraphError
        If the graph lacks one of them.
    """
    asked = tuple(dict.fromkeys(names))
    for name in asked:
        if name not in graph.nodes:
            raise NodegraphError(f"the graph has no node {name!r}; {nearest(name, graph.nodes)}")
    kept = set(asked)
    for name in reversed(list(graph.nodes)):
        if name in kept:
            methods = graph.nodes[name].methods.values()
            feeds = (fed for method in methods for fed in method.inputs.values())
            kept.update(source.node for fed in feeds for source in sources_of(fed))
    report = tuple(Reference(name, "", graph.nodes[name].place) for name in asked)
    nodes = {name: node for name, node in graph.nodes.items() if name in kept}
    return replace(graph, nodes=nodes, spec=replace(graph.spec, report=report))


@dataclass(frozen=True)
class Feed:
    """What a node feeds to a port of the graph that it uses.

    Attributes
    ----------
    where : str
        Names the node in messages.
    port : Port or None
        None where the graph has no such port; that is told already.
    """

    where: str
    port: Port | None
    source: Reference


@dataclass(frozen=True)
class Flat:
    """A graph in which no node uses another graph any more.

    Attributes
    ----------
    spec : GraphSpec
        Its nodes are its own, what stands for its ports (``$recording``), and those of the graphs
        that it uses (``clean.despike``).
    ports : mapping of name to Port
        Its inputs that are ports.
    graphs : mapping of node to (mapping of label to Registered)
        What stands for the graphs that its nodes use, and for its ports.
    feeds : tuple of Feed
    given : tuple of Written
        Settings that it gives to the graphs that it uses.
    is_whole : bool
        Whether every graph that it uses could be put in its place.
    """

    spec: GraphSpec
    ports: Mapping[str, Port]
    graphs: Mapping[str, Mapping[str, Registered]]
    feeds: tuple[Feed, ...]
    given: tuple[Written, ...]
    is_whole: bool


@dataclass(frozen=True)
class HandsOn(Node):
    """A node whose outputs are its inputs, one by one in the same order.

    Attributes
    ----------
    takes, gives : tuple of Port
        As many outputs as inputs.
    asks : tuple of Port
        What whoever uses it must feed. For a graph these are its own ports, which feed the nodes
        inside; what it takes comes from there.
    offers : tuple of str
        The outputs of all that it stands for: a graph's, of which it may hand on one alone.
    about : str
        What a reader of the report sees.
    """

    takes: tuple[Port, ...] = ()
    gives: tuple[Port, ...] = ()
    asks: tuple[Port, ...] = ()
    offers: tuple[str, ...] = ()
    about: str = ""

    @cached_property
    def inputs(self) -> tuple[Port, ...]:
        """What it takes."""
        return self.takes

    @cached_property
    def outputs(self) -> tuple[Port, ...]:
        """What it hands on."""
        return self.gives

    @cached_property
    def settings(self) -> Mapping[str, Setting]:
        """None."""
        return {}

    @cached_property
    def splits(self) -> bool:
        """Whether it hands on several values."""
        return len(self.gives) > 1

    @property
    def doc(self) -> str:
        """What a reader of the report sees."""
        return self.about


def asked(node: Node) -> tuple[Port, ...]:
    """Return the ports that whoever uses a node must feed."""
    return node.asks if isinstance(node, HandsOn) else node.inputs


def offered(node: Node) -> tuple[str, ...]:
    """Return the outputs that a reference to a node may name."""
    return node.offers if isinstance(node, HandsOn) else tuple(one.name for one in node.outputs)


def passing(sibling: Node) -> HandsOn:
    """Return what hands on its first input, typed and named as the sibling's first output."""
    gives = tuple(replace(port, columns=()) for port in sibling.outputs[:1])
    takes = tuple(replace(port, type=gives[0].type) for port in asked(sibling)[:1])
    about = "Hand on the input as it is."
    return HandsOn("pass", _hand_on, (), takes, gives, takes, (gives[0].name,), about)


def graph_node(
    use: str,
    title: str,
    asks: tuple[Port, ...],
    outputs: tuple[Port, ...],
    offers: tuple[str, ...],
) -> HandsOn:
    """Return what stands for a graph used as a node: it hands on what the nodes inside give."""
    return HandsOn(use, _hand_on, (), outputs, outputs, asks, offers, title)


def port_node(port: Port) -> HandsOn:
    """Return what stands inside a graph for one of its ports, while it is checked by itself."""
    return HandsOn(port.type.__name__, _hand_on, (), (), (Port("value", port.type),))


def _hand_on(**inputs: Any) -> Any:
    if len(inputs) == 1:
        return next(iter(inputs.values()))
    return SimpleNamespace(**inputs)
