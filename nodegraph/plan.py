"""Plan the steps of a graph: every combination of axes once, and equal calls once."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, NamedTuple

from nodegraph.formatting import name_at
from nodegraph.gc_pause import gc_paused
from nodegraph.graph import Gather, Graph, GraphNode, Method
from nodegraph.graph.axis_text import axis_text
from nodegraph.graphfile.spec import Reference, SkipSpec
from nodegraph.node.declaration import Declared
from nodegraph.node.ports import Absent, Across, Label
from nodegraph.state import State

if TYPE_CHECKING:
    import networkx as nx

Combination = tuple[Label, ...]


class Output(NamedTuple):
    """One output of a step: the index of the step, and the position among its outputs."""

    step: int
    position: int


StepInput = Output | Across[Output]
"""What feeds a port: an output, or several with the labels at which they are gathered."""


def outputs_in(inputs: Iterable[StepInput]) -> Iterator[Output]:
    """Yield every output that feeds some ports."""
    for source in inputs:
        yield from (source,) if isinstance(source, Output) else source.values()


class Step(NamedTuple):  # a frozen dataclass takes four times as long to create
    """One call of one method.

    Attributes
    ----------
    index : int
        Its place in the plan, after the steps that feed it.
    node : str
    method : Method
    labels : mapping of axis to label
        The first combination that needs the step; others may share it.
    settings : mapping
        The settings with which the function is called.
    shown : mapping
        The settings in the form in which they were written.
    inputs : mapping of port to Output, or to Across of Output
    needed : tuple of int
        The steps that feed it, each once.
    """

    index: int  # type: ignore[assignment]  # tuples have a method of that name
    node: str
    method: Method
    labels: Mapping[str, Label]
    settings: Mapping[str, Any]
    shown: Mapping[str, object]
    inputs: Mapping[str, StepInput]
    needed: tuple[int, ...]

    @property
    def name(self) -> str:
        """The node and its combination: ``fill(length=5, fill=muscle)``."""
        return name_at(self.node, self.labels)

    def reads(self) -> Iterator[Output]:
        """Yield the outputs that feed it."""
        return outputs_in(self.inputs.values())


@dataclass(frozen=True)
class Plan:
    """The steps of a graph, and the step that computes each combination.

    Attributes
    ----------
    graph : Graph
    steps : tuple of Step
        Each after those that feed it, and soon after them, so that values are released early.
    cells : mapping of node to (mapping of combination to step index)
    skipped : mapping of node to (mapping of combination to reason)
    """

    graph: Graph
    steps: tuple[Step, ...]
    cells: Mapping[str, Mapping[Combination, int]]
    skipped: Mapping[str, Mapping[Combination, str]]

    def skipped_together(self) -> Mapping[str, Mapping[str, int]]:
        """Return the number of skipped combinations of each node by reason."""
        together: dict[str, dict[str, int]] = {}
        for node, reasons in self.skipped.items():
            for reason, count in Counter(reasons.values()).items():
                together.setdefault(reason, {})[node] = count
        return together

    @cached_property
    def network(self) -> nx.DiGraph[int]:
        """The indices of the steps, with an edge from each step to every reader of it.

        Examples
        --------
        >>> networkx.ancestors(plan.network, step.index)  # what a step is computed from
        """
        import networkx as nx

        network: nx.DiGraph[int] = nx.DiGraph()
        network.add_nodes_from(range(len(self.steps)))
        network.add_edges_from(
            (source, step.index) for step in self.steps for source in step.needed
        )
        nx.freeze(network)
        return network


@gc_paused()
def plan(graph: Graph) -> Plan:
    """Return the steps that compute every node of a graph at every combination."""
    planner = _Planner(graph)
    for node in graph.nodes.values():
        planner.add(node)
    return planner.plan()


class _Planner:
    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        # in the order in which they are added
        self._steps: list[Step] = []
        self._by_call: dict[tuple[object, ...], int] = {}
        self._cells: dict[str, dict[Combination, int]] = {}
        self._skipped: dict[str, dict[Combination, str]] = {}
        self._known_labels: dict[tuple[str, ...], tuple[Label, ...]] = {}
        self._source_axes: dict[str, frozenset[str]] = {}
        self._read: dict[str, _Read] = {}
        self._units: dict[str, str] = {}
        self._methods: dict[str, Mapping[Label, Declared]] = {}

    def add(self, node: GraphNode) -> None:
        """Add the steps of a node; those of the nodes that feed it must be there."""
        cells: dict[Combination, int] = {}
        skipped: dict[Combination, str] = {}
        self._cells[node.name], self._skipped[node.name] = cells, skipped
        rules = [
            (skip_reason(rule), rule.labels.items())
            for rule in self._graph.spec.skip
            if rule.labels.keys() <= set(node.axes)
        ]
        # equal texts are equal settings
        texts = {
            label: {row: repr(sorted(values.items())) for row, values in m.settings.values.items()}
            for label, m in node.methods.items()
        }
        for combination in itertools.product(*(self._labels(axis) for axis in node.axes)):
            labels = dict(zip(node.axes, combination, strict=True))
            reasons = [why for why, of in rules if all([labels[axis] in at for axis, at in of])]
            step = reasons[0] if reasons else self._step(node, labels, texts)
            if isinstance(step, str):
                skipped[combination] = step
            else:
                cells[combination] = step

    def plan(self) -> Plan:
        """Return the plan of all that was added."""
        order = _depth_first_order([step.needed for step in self._steps])
        if order == list(range(len(order))):
            return Plan(self._graph, tuple(self._steps), self._cells, self._skipped)
        index = [0] * len(order)
        for new, old in enumerate(order):
            index[old] = new
        steps = tuple([_renumbered(self._steps[old], index) for old in order])
        cells = {
            name: {combination: index[step] for combination, step in cells.items()}
            for name, cells in self._cells.items()
        }
        return Plan(self._graph, steps, cells, self._skipped)

    def _step(
        self,
        node: GraphNode,
        labels: Mapping[str, Label],
        texts: Mapping[str, Mapping[Combination, str]],
    ) -> int | str:
        """Return the step of one combination, or why there is none."""
        label = str(labels[node.name]) if node.has_alternatives else ""
        method = node.methods[label]
        inputs: dict[str, StepInput] = {}
        needed: dict[int, None] = {}
        for port, feed in method.inputs.items():
            source: StepInput | str
            if isinstance(feed, Reference):
                source = self._output(feed, labels)
            else:
                source = self._gathered(node, feed, labels)
            if isinstance(source, str):
                return source
            inputs[port] = source
            if isinstance(source, Output):
                needed[source.step] = None
            else:
                needed |= dict.fromkeys([output.step for output in source.values()])
        row = tuple([labels[axis] for axis in method.settings.axes])
        fed = [
            (port, source if isinstance(source, Output) else _comparable(source))
            for port, source in inputs.items()
        ]
        call = (method.plugin, method.node.name, texts[label][row], *fed)
        index = self._by_call.setdefault(call, len(self._steps))
        if index == len(self._steps):
            values, shown = method.settings.values[row], method.settings.shown[row]
            step = Step(index, node.name, method, labels, values, shown, inputs, tuple(needed))
            self._steps.append(step)
        return index

    def _gathered(
        self, node: GraphNode, feed: Gather, labels: Mapping[str, Label]
    ) -> Across[Output] | str:
        """Return the sources of a gathering port at one combination, or why it has none."""
        axes = self._gathered_axes(node, feed)
        entries: list[tuple[Combination, Output]] = []
        absent: list[tuple[Combination, str]] = []
        for label, source in feed.sources.items():
            free = self._free_axes(node, source)
            for combination in itertools.product(*(self._labels(axis) for axis in free)):
                at = dict(zip(free, combination, strict=True))
                output = self._output(source, {**labels, **at})
                at[feed.axis] = label
                row = tuple(at.get(axis, "") for axis in axes)
                if isinstance(output, str):
                    absent.append((row, output))
                else:
                    entries.append((row, output))
        if not entries:
            return "everything that it gathers is left out"
        # a node inside a graph used as a node sees its axes under the names that they have there
        names = tuple(map(node.local_name, axes))
        known = {
            name: self._labels_like(tuple(feed.sources))
            if axis == feed.axis
            else self._labels(axis)
            for name, axis in zip(names, axes, strict=True)
        }
        sources = tuple(
            name for name, axis in zip(names, axes, strict=True) if self._feeds_source(axis, feed)
        )
        unused = _unused_axes(names, entries)
        methods = {
            name: declared
            for name, axis in zip(names, axes, strict=True)
            if (declared := self._declared(axis))
        }
        fields = {
            f"{name}.{field}": of
            for name, axis in zip(names, axes, strict=True)
            if axis in self._graph.axes
            for field, of in self._graph.axes[axis].fields.items()
        }
        read = [self._data_of(source.node) for source in feed.sources.values()]
        units = {name: self._unit(axis) for name, axis in zip(names, axes, strict=True)}
        return Across(
            names,
            tuple((dict(zip(names, row, strict=True)), output) for row, output in entries),
            tuple(
                Absent(dict(zip(names, row, strict=True)), State.SKIPPED.value, reason)
                for row, reason in absent
            ),
            known,
            sources,
            unused,
            methods,
            fields,
            all(each.synthetic for each in read),
            {name: unit for name, unit in units.items() if unit},
            tuple(dict.fromkeys(file for each in read for file in each.files)),
        )

    def _declared(self, axis: str) -> Mapping[Label, Declared]:
        """Return the declarations of the alternatives of an axis; empty for other axes."""
        if axis not in self._methods:  # needed for every combination of a node
            node = self._graph.nodes.get(axis)
            known = node.methods.values() if node is not None and node.has_alternatives else ()
            self._methods[axis] = {method.label: _declared(method) for method in known}
        return self._methods[axis]

    def _feeds_source(self, axis: str, feed: Gather) -> bool:
        """Whether the data differ along a gathered axis, or among a port's own labels."""
        nodes = [source.node for source in feed.sources.values()]
        if axis == feed.axis:
            return len({self._graph.sources(node) for node in nodes}) > 1
        return any(axis in self._axes_of_sources(node) for node in nodes)

    def _data_of(self, node: str) -> _Read:
        """Return what the nodes say of themselves that a node has its data from."""
        if node not in self._read:  # needed for every combination of a node
            indices = {
                index for name in self._graph.sources(node) for index in self._cells[name].values()
            }
            steps = [self._steps[index] for index in sorted(indices)]
            self._read[node] = _Read(
                all(step.method.node.is_synthetic(step.settings) for step in steps),
                tuple(dict.fromkeys(name for step in steps for name in _file_names(step))),
            )
        return self._read[node]

    def _unit(self, axis: str) -> str:
        if axis not in self._units:  # needed for every combination of a node
            self._units[axis] = axis_text(self._graph, axis).unit
        return self._units[axis]

    def _axes_of_sources(self, node: str) -> frozenset[str]:
        if node not in self._source_axes:  # needed for every combination of a node
            self._source_axes[node] = self._graph.source_axes(node)
        return self._source_axes[node]

    def _output(self, source: Reference, labels: Mapping[str, Label]) -> Output | str:
        fixed, axes = source.at, self._graph.nodes[source.node].axes
        at = tuple([fixed[axis] if axis in fixed else labels[axis] for axis in axes])
        step = self._cells[source.node].get(at)
        if step is None:
            return self._skipped[source.node].get(at, f"{source.node} is left out")
        if not source.port:
            return Output(step, 0)
        outputs = self._steps[step].method.node.outputs
        return Output(step, [port.name for port in outputs].index(source.port))

    def _gathered_axes(self, node: GraphNode, feed: Gather) -> tuple[str, ...]:
        free = {axis for source in feed.sources.values() for axis in self._free_axes(node, source)}
        axes = tuple(axis for axis in node.gathered if axis in free)
        return (feed.axis, *axes) if feed.axis else axes

    def _free_axes(self, node: GraphNode, source: Reference) -> tuple[str, ...]:
        """Return the axes of a source that the node gathers."""
        axes = self._graph.nodes[source.node].axes
        return tuple(axis for axis in axes if axis in node.gathered and axis not in source.at)

    def _labels(self, axis: str) -> tuple[Label, ...]:
        return self._graph.axes[axis].labels

    def _labels_like(self, own: tuple[str, ...]) -> tuple[Label, ...]:
        """Return the labels of the first axis that has all of a port's own labels, else these."""
        if own not in self._known_labels:  # needed for every combination of a node
            axes = (axis.labels for axis in self._graph.axes.values())
            like = (labels for labels in axes if set(own) <= set(map(str, labels)))
            self._known_labels[own] = next(like, own)
        return self._known_labels[own]


def skip_reason(item: SkipSpec) -> str:
    """Return why a rule leaves out combinations, in the same words for all of them."""
    labels = (f"{axis} = {' or '.join(map(str, of))}" for axis, of in item.labels.items())
    return f"skip: {', '.join(labels)}"


def _comparable(source: Across[Output]) -> object:
    """Return what two calls have in common that gather alike at a port; it can be hashed."""
    entries = tuple((*labels.values(), output) for labels, output in source)
    absent = tuple((*each.labels.values(), each.reason) for each in source.absent)
    return source.axes, entries, absent, tuple(source.known.values()), source.sources, source.unused


def _unused_axes(
    axes: tuple[str, ...], entries: Sequence[tuple[Combination, Output]]
) -> tuple[tuple[str, ...], ...]:
    """Return for each entry the axes that it does not depend on; see `Across.unused`."""
    if len({output for _, output in entries}) == len(entries):
        return ()
    unused: list[list[str]] = [[] for _ in entries]
    for position, axis in enumerate(axes):
        alike: dict[Combination, list[int]] = {}
        for index, (row, _) in enumerate(entries):
            alike.setdefault((*row[:position], *row[position + 1 :]), []).append(index)
        for indices in alike.values():
            if len(indices) > 1 and len({entries[index][1] for index in indices}) == 1:
                for index in indices:
                    unused[index].append(axis)
    return tuple(map(tuple, unused))


@dataclass(frozen=True)
class _Read:
    """The data behind a node: whether all are made by a generator, and the names of their files."""

    synthetic: bool
    files: tuple[str, ...]


def _file_names(step: Step) -> Iterator[str]:
    for setting in step.method.node.settings.values():
        if setting.is_file and step.settings[setting.name] is not None:
            yield PurePath(str(step.settings[setting.name])).name


def _declared(method: Method) -> Declared:
    """Return the declarations of a method; where settings vary, those that hold for all."""
    node = method.node
    settings = list(method.settings.values.values())
    adapted = dict.fromkeys(node.adapted_from(values) for values in settings)
    declared: Declared = {"adapted": text} if (text := "; ".join(filter(None, adapted))) else {}
    if method.settings.axes:
        declared["axes"] = method.settings.axes
    frames = [node.lookahead(values) for values in settings]
    known = [count for count in frames if isinstance(count, int)]
    if None in frames:
        declared["lookahead"] = None
    elif known:
        declared["lookahead"] = max(known)
    ends = [met for values in settings if (met := node.meets_ends(values)) is not None]
    if ends:
        declared["ends"] = all(ends)
    return declared


def _depth_first_order(needed: Sequence[tuple[int, ...]]) -> list[int]:
    """Return the steps, each after those that it needs, so that few values wait at a time.

    The same as networkx's ``dfs_postorder_nodes``, in less than a third of its time.
    """
    read = {source for sources in needed for source in sources}
    order: list[int] = []
    seen: set[int] = set()
    for last in (step for step in range(len(needed)) if step not in read):
        stack = [(last, iter(needed[last]))]
        while stack:
            step, sources = stack[-1]
            for source in sources:
                if source not in seen:
                    seen.add(source)
                    stack.append((source, iter(needed[source])))
                    break
            else:
                order.append(step)
                stack.pop()
    return order


def _renumbered(step: Step, indices: Sequence[int]) -> Step:
    """Return a step with the final indices of itself and of those that feed it."""
    index, needed = indices[step.index], tuple([indices[each] for each in step.needed])
    if index == step.index and needed == step.needed:
        return step
    inputs = {port: _renumbered_input(source, indices) for port, source in step.inputs.items()}
    return step._replace(index=index, inputs=inputs, needed=needed)


def _renumbered_input(source: StepInput, indices: Sequence[int]) -> StepInput:
    if isinstance(source, Output):
        return Output(indices[source.step], source.position)
    entries = [(at, Output(indices[step], position)) for at, (step, position) in source]
    return replace(source, entries=tuple(entries))
