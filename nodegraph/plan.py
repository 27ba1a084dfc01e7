"""Typed graph -> steps: every combination of axes once, shared prefixes once, in a lean order."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from nodegraph.formatting import name_at
from nodegraph.gc_pause import gc_paused
from nodegraph.graph import Gather, Graph, GraphNode, Method
from nodegraph.graphfile.spec import Reference
from nodegraph.node.ports import Absent, Label
from nodegraph.state import State

Combination = tuple[Label, ...]


@dataclass(frozen=True, slots=True)
class Output:
    """One output of a step: the step's index, and the position among its outputs."""

    step: int
    position: int


@dataclass(frozen=True, slots=True)
class Gathered:
    """What a gathering port takes: outputs with their labels, and combinations left out.

    Attributes
    ----------
    axes : tuple of str
    entries : tuple of (labels, Output)
    absent : tuple of (labels, reason)
    known : tuple of labels per axis
        Every label that the graph has there, whether or not it is among the entries.
    """

    axes: tuple[str, ...]
    entries: tuple[tuple[Combination, Output], ...]
    absent: tuple[tuple[Combination, str], ...]
    known: tuple[tuple[Label, ...], ...]


StepInput = Output | Gathered


@dataclass(frozen=True, slots=True)
class Step:
    """One call of one method.

    Attributes
    ----------
    index : int
        Its place in the order of the plan: what it needs comes before it.
    node : str
    method : Method
    labels : mapping of axis to label
        The first combination that needs the step; others may share it.
    settings : mapping
        What the function is called with.
    shown : mapping
        The same as a reader wrote it.
    inputs : mapping of port to Output or Gathered
    needed : tuple of int
        The steps that feed it, each once.
    """

    index: int
    node: str
    method: Method
    labels: Mapping[str, Label]
    settings: Mapping[str, Any]
    shown: Mapping[str, Any]
    inputs: Mapping[str, StepInput]
    needed: tuple[int, ...]

    @property
    def name(self) -> str:
        """The node and its combination: ``fill(length=5, fill=muscle)``."""
        return name_at(self.node, self.labels)

    def reads(self) -> Iterator[Output]:
        """Yield the outputs that feed it."""
        for fed in self.inputs.values():
            if isinstance(fed, Gathered):
                yield from (output for _, output in fed.entries)
            else:
                yield fed


@dataclass(frozen=True)
class Plan:
    """All steps of a graph, and which step computes which combination.

    Attributes
    ----------
    graph : Graph
    steps : tuple of Step
        Each after what feeds it, and as soon after it as can be, so that values are released early.
    cells : mapping of node to (mapping of combination to step index)
    skipped : mapping of node to (mapping of combination to reason)
    """

    graph: Graph
    steps: tuple[Step, ...]
    cells: Mapping[str, Mapping[Combination, int]]
    skipped: Mapping[str, Mapping[Combination, str]]


def absent_of(gathered: Gathered) -> tuple[Absent, ...]:
    """Return the combinations that the plan itself has left out of a gathering."""
    return tuple(
        Absent(dict(zip(gathered.axes, at, strict=True)), State.SKIPPED.value, reason)
        for at, reason in gathered.absent
    )


def lean_order(steps: list[Step]) -> list[int]:
    """Return the steps depth first from the last ones, so that few values wait at a time."""
    read = {needed for step in steps for needed in step.needed}
    order: list[int] = []
    done: set[int] = set()
    for last in (step for step in steps if step.index not in read):
        pending = [(last, iter(last.needed))]
        done.add(last.index)
        while pending:
            step, needs = pending[-1]
            following = next((one for one in needs if one not in done), None)
            if following is None:
                order.append(step.index)
                pending.pop()
            else:
                done.add(following)
                pending.append((steps[following], iter(steps[following].needed)))
    return order


def needed_by(inputs: Mapping[str, StepInput]) -> tuple[int, ...]:
    """Return the steps that feed the ports of another, each once."""
    found: dict[int, None] = {}
    for fed in inputs.values():
        if isinstance(fed, Output):
            found[fed.step] = None
        else:
            found.update((output.step, None) for _, output in fed.entries)
    return tuple(found)


def moved_step(step: Step, moved: Mapping[int, int]) -> Step:
    """Return a step, and what it says of others, with the indices that they have now."""
    inputs = {port: _moved_input(fed, moved) for port, fed in step.inputs.items()}
    return Step(
        moved[step.index],
        step.node,
        step.method,
        step.labels,
        step.settings,
        step.shown,
        inputs,
        tuple([moved[one] for one in step.needed]),
    )


def _moved_input(fed: StepInput, moved: Mapping[int, int]) -> StepInput:
    if isinstance(fed, Output):
        return Output(moved[fed.step], fed.position)
    entries = tuple((at, Output(moved[one.step], one.position)) for at, one in fed.entries)
    return replace(fed, entries=entries)


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
        self._steps: list[Step] = []
        self._same: dict[tuple[Any, ...], int] = {}
        self._cells: dict[str, dict[Combination, int]] = {}
        self._skipped: dict[str, dict[Combination, str]] = {}
        self._axes_like: dict[tuple[str, ...], tuple[Label, ...]] = {}

    def add(self, node: GraphNode) -> None:
        cells: dict[Combination, int] = {}
        skipped: dict[Combination, str] = {}
        self._cells[node.name], self._skipped[node.name] = cells, skipped
        texts = {label: _texts(method) for label, method in node.methods.items()}
        for combination in itertools.product(*(self._labels(axis) for axis in node.axes)):
            labels = dict(zip(node.axes, combination, strict=True))
            reason = self._skip_reason(labels)
            if not reason:
                reason = self._add_step(node, labels, texts, cells, combination)
            if reason:
                skipped[combination] = reason

    def plan(self) -> Plan:
        order = lean_order(self._steps)
        moved = {old: new for new, old in enumerate(order)}
        steps = tuple(moved_step(self._steps[old], moved) for old in order)
        cells = {
            name: {combination: moved[step] for combination, step in found.items()}
            for name, found in self._cells.items()
        }
        return Plan(self._graph, steps, cells, self._skipped)

    def _add_step(
        self,
        node: GraphNode,
        labels: Mapping[str, Label],
        texts: Mapping[str, Mapping[Combination, str]],
        cells: dict[Combination, int],
        combination: Combination,
    ) -> str:
        """Add the step of one combination; return why there is none, if there is none."""
        label = str(labels[node.name]) if node.has_alternatives else ""
        method = node.methods[label]
        inputs: dict[str, StepInput] = {}
        for port, fed in method.inputs.items():
            found = self._input(node, fed, labels)
            if isinstance(found, str):
                return found
            inputs[port] = found
        row = tuple(labels[axis] for axis in method.settings.axes)
        same = (method.plugin, method.node.name, texts[label][row], *inputs.items())
        index = self._same.setdefault(same, len(self._steps))
        if index == len(self._steps):
            settings = method.settings
            self._steps.append(
                Step(
                    index,
                    node.name,
                    method,
                    labels,
                    settings.values[row],
                    settings.shown[row],
                    inputs,
                    needed_by(inputs),
                )
            )
        cells[combination] = index
        return ""

    def _input(
        self, node: GraphNode, fed: Reference | Gather, labels: Mapping[str, Label]
    ) -> StepInput | str:
        if isinstance(fed, Reference):
            return self._output(fed, labels)
        axes = self._gathered_axes(node, fed)
        entries: list[tuple[Combination, Output]] = []
        absent: list[tuple[Combination, str]] = []
        for label, source in fed.sources.items():
            for here in self._combinations(node, source):
                found = self._output(source, {**labels, **here})
                named = {**here, fed.axis: label}
                at = tuple(named.get(axis, "") for axis in axes)
                if isinstance(found, str):
                    absent.append((at, found))
                else:
                    entries.append((at, found))
        if not entries:
            return "everything that it gathers is left out"
        # a node of a graph that is used as a node knows its axes by the names they have there
        inside = tuple(map(node.local_name, axes))
        return Gathered(inside, tuple(entries), tuple(absent), self._known(axes, fed))

    def _known(self, axes: tuple[str, ...], fed: Gather) -> tuple[tuple[Label, ...], ...]:
        """Return every label of each gathered axis.

        Labels that a port gives of its own are, where they are those of an axis, that axis's.
        """
        own = tuple(fed.sources)
        return tuple(self._like(own) if axis == fed.axis else self._labels(axis) for axis in axes)

    def _like(self, own: tuple[str, ...]) -> tuple[Label, ...]:
        """Return the labels of the first axis that has all of these, else these."""
        if own not in self._axes_like:  # asked for every combination of a node
            every = (one.labels for one in self._graph.axes.values())
            found = (labels for labels in every if set(own) <= set(map(str, labels)))
            self._axes_like[own] = next(found, own)
        return self._axes_like[own]

    def _gathered_axes(self, node: GraphNode, fed: Gather) -> tuple[str, ...]:
        found = {axis for one in fed.sources.values() for axis in self._free(node, one)}
        named = tuple(axis for axis in node.gathered if axis in found)
        return (fed.axis, *named) if fed.axis else named

    def _free(self, node: GraphNode, source: Reference) -> tuple[str, ...]:
        """Return the axes of a source that the node gathers."""
        axes = self._graph.nodes[source.node].axes
        return tuple(one for one in axes if one in node.gathered and one not in source.at)

    def _combinations(self, node: GraphNode, source: Reference) -> Iterator[dict[str, Label]]:
        free = self._free(node, source)
        for combination in itertools.product(*(self._labels(axis) for axis in free)):
            yield dict(zip(free, combination, strict=True))

    def _output(self, source: Reference, labels: Mapping[str, Label]) -> Output | str:
        node = self._graph.nodes[source.node]
        at = tuple(source.at[axis] if axis in source.at else labels[axis] for axis in node.axes)
        index = self._cells[source.node].get(at)
        if index is None:
            return self._skipped[source.node].get(at, f"{source.node} is left out")
        outputs = self._steps[index].method.node.outputs
        names = [port.name for port in outputs]
        return Output(index, names.index(source.port) if source.port else 0)

    def _labels(self, axis: str) -> tuple[Label, ...]:
        return self._graph.axes[axis].labels

    def _skip_reason(self, labels: Mapping[str, Label]) -> str:
        for item in self._graph.spec.skip:
            if all(axis in labels and labels[axis] in item.labels[axis] for axis in item.labels):
                return f"skip: {', '.join(f'{axis} = {labels[axis]}' for axis in item.labels)}"
        return ""


def _texts(method: Method) -> dict[Combination, str]:
    """Return each row of settings as one text: equal texts are equal settings."""
    return {row: repr(sorted(values.items())) for row, values in method.settings.values.items()}
