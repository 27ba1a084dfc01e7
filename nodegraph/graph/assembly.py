"""Assembly of a typed graph: nodes in order, with their axes, wires and settings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial

import networkx as nx

from nodegraph.errors import Place, Problems, nearest, quoted
from nodegraph.graph.axes import check_combinations, check_fixed_axes, node_axes
from nodegraph.graph.flatten import FlatGraph
from nodegraph.graph.methods import (
    ResolvedMethod,
    at_first_labels,
    check_requires,
    deprecations,
    resolve_methods,
)
from nodegraph.graph.model import Choices, Graph, GraphNode, LeftOut, Method, method_name
from nodegraph.graph.namespace import Namespace
from nodegraph.graph.settings import SettingsReader
from nodegraph.graph.wiring import WireChecker, sorted_names, typed_network
from nodegraph.graphfile.axes import is_label
from nodegraph.graphfile.spec import NodeSpec, Reference, SkipSpec
from nodegraph.plugin.registry import Registry


class Assembler:
    """Puts one graph together and records every error in it.

    Parameters
    ----------
    flat
    registry
    choices
    problems
        Receives the errors.
    """

    def __init__(
        self, flat: FlatGraph, registry: Registry, choices: Choices, problems: Problems
    ) -> None:
        spec = flat.spec
        self._flat = flat
        self._registry = registry
        self._problems = problems
        self._choices = choices
        self._namespace = Namespace(spec, flat.ports, choices, problems)
        self._settings = SettingsReader(self._namespace, registry, problems)
        self._methods = {
            name: resolve_methods(node, registry, flat.stand_ins.get(name, {}), problems)
            for name, node in spec.nodes.items()
        }
        for name, node in spec.nodes.items():
            if node.has_alternatives:
                labels = tuple(method.label for method in self._methods[name])
                self._namespace.add_alternatives(name, labels)
        axes = self._namespace.axes
        for name, methods in self._methods.items():
            self._methods[name] = [method.with_first_labels(axes) for method in methods]
        self._spec = replace(
            spec,
            report=tuple(at_first_labels(entry, axes) for entry in spec.report),
        )
        self._nodes: dict[str, GraphNode] = {}
        self._wires = WireChecker(spec, self._nodes, self._namespace, problems)
        self._left_out: list[LeftOut] = []
        self._incomplete: set[str] = set()  # nodes that may lack an axis because of an error
        self._ignored = Problems()  # errors that may follow from those

    def graph(self) -> Graph | None:
        """Return the graph, or None if there are errors, in it or in a graph that it uses."""
        sources = {
            name: [source for method in methods for source in method.references()]
            for name, methods in self._methods.items()
        }
        for name in sorted_names(sources, self._problems):
            self._nodes[name] = self._node(self._spec.nodes[name])
        self._check_graph_inputs()
        self._check_sections()
        self._namespace.check_choices()
        skip = self._checked_skip()
        check_requires(self._spec, self._problems)
        few = check_combinations(self._nodes, self._namespace.axes, self._problems)
        self._settings.fill(in_full=few)
        if self._problems or not self._flat.is_complete:
            return None
        network = typed_network(self._nodes)
        self._remove_left_out(network)
        labels = {name: axis.labels for name, axis in self._namespace.axes.items()}
        return Graph(
            replace(self._spec, skip=skip),
            self._registry,
            nx.freeze(network),
            self._namespace.axes,
            self._namespace.inputs,
            self._choices,
            tuple(self._left_out),
            deprecations(self._spec.nodes.values(), self._methods, labels, self._registry),
        )

    def _node(self, spec: NodeSpec) -> GraphNode:
        resolved = self._methods[spec.name]
        labels = self._namespace.axes[spec.name].labels if spec.has_alternatives else ("",)
        every = [method for each in resolved if (method := self._method(spec, each)) is not None]
        methods = {method.label: method for method in every if method.label in labels}
        gathers = any(method.gathers for method in every)
        if spec.over and methods and not gathers:
            self._problems.add(spec.over[0][1], f"{spec.name}: 'over' needs a port that gathers")
        sources = (source for method in methods.values() for source in method.references())
        removed = [self._check_fixed_axes(source) for source in sources if source.at]
        if labels_removed := list(dict.fromkeys(filter(None, removed))):
            reason = f"the command has removed {', '.join(labels_removed)}"
            self._left_out.append(LeftOut(spec.name, reason))
        if not all(map(self._is_complete, resolved)):
            self._incomplete.add(spec.name)
        is_certain = gathers and spec.name not in self._incomplete
        axes, gathered = node_axes(
            spec,
            every,
            self._nodes,
            self._namespace.axes,
            self._problems if is_certain else self._ignored,
        )
        node = GraphNode(
            spec.name, spec.place, methods, spec.has_alternatives, axes, gathered, spec.prefix
        )
        if gathers:
            self._check_gathered_names(node)
        return node

    def _is_complete(self, method: ResolvedMethod) -> bool:
        """Whether everything that gives a method its axes is valid."""
        if method.registered is None:
            return False
        for name, written in method.settings.items():
            if variables := written.variables():
                if name not in method.registered.node.settings:
                    return False
                if not self._namespace.invalid.isdisjoint(variables):
                    return False
        sources = {source.node for source in method.references()}
        return sources <= self._nodes.keys() and sources.isdisjoint(self._incomplete)

    def _method(self, spec: NodeSpec, method: ResolvedMethod) -> Method | None:
        where = method_name(spec.name, method.label)
        if method.registered is None:
            self._namespace.use(method.settings.values())
            for source in method.references():
                self._wires.check(source, None, where)
            return None
        node = method.registered.node
        return Method(
            label=method.label,
            node=node,
            plugin=method.registered.plugin,
            distribution=method.registered.distribution,
            inputs=self._wires.inputs(where, method, node),
            settings=self._settings.read(where, method, node),
            place=method.place,
            places={
                name: self._namespace.place(written) for name, written in method.settings.items()
            },
        )

    def _check_gathered_names(self, node: GraphNode) -> None:
        """Record axes that the node would see under the same name."""
        names = [node.local_name(axis) for axis in node.gathered]
        for name in dict.fromkeys(name for name in names if names.count(name) > 1):
            message = f"{node.name}: gathers two axes with the inner name {quoted(name)}"
            self._problems.add(node.place, message, f"rename one of the axes {quoted(name)}")
        for method in node.methods.values():
            for gather in method.gathers:
                if gather.axis in names:
                    place = next(iter(gather.sources.values())).place
                    message = f"port {quoted(gather.axis)} gathers an axis of the same name"
                    instead = f"rename the axis {quoted(gather.axis)}"
                    self._problems.add(place, f"{node.name}: {message}", instead)

    def _check_fixed_axes(self, source: Reference) -> str:
        """Check the axes that a reference fixes; return the label that was removed, if any."""
        if not source.at or source.node in self._incomplete:
            return ""
        return check_fixed_axes(source, self._nodes, self._namespace.axes, self._problems)

    def _check_graph_inputs(self) -> None:
        """Check what feeds, and what sets, the graphs used as nodes."""
        for graph_input in self._flat.inputs:
            source = at_first_labels(graph_input.source, self._namespace.axes)
            self._wires.check(source, graph_input.port, graph_input.where)
            self._check_fixed_axes(source)
        self._namespace.use(self._flat.settings)

    def _check_sections(self) -> None:
        spec = self._spec
        sections = {"outputs": spec.outputs.values(), "known": spec.known, "report": spec.report}
        for section, references in sections.items():
            for reference in references:
                self._wires.check(reference, None, section)
                self._check_fixed_axes(reference)

    def _checked_skip(self) -> tuple[SkipSpec, ...]:
        """Return the rules that apply to the nodes."""
        axes, rules = self._namespace.axes, []
        for item in self._spec.skip:
            for axis, labels in item.labels.items():
                if axis in axes:
                    self._check_skip_labels(item.place, axis, labels)
                else:
                    hint = partial(nearest, axis, axes, what="axes")
                    self._problems.add(item.place, f"skip: no axis {quoted(axis)}", hint)
            if self._incomplete or not item.labels.keys() <= axes.keys():
                continue
            if any(item.labels.keys() <= set(node.axes) for node in self._nodes.values()):
                rules.append(item)
            else:
                names = " and ".join(item.labels)
                self._problems.add(item.place, f"skip: no node has the axes {names} together")
        return tuple(rules)

    def _check_skip_labels(self, place: Place, axis: str, labels: Iterable[object]) -> None:
        known = self._namespace.axes[axis]
        there = {*known.labels, *known.removed}
        for label in labels:
            if not is_label(label) or label not in there:
                hint = partial(nearest, label, known.labels, what="labels")
                message = f"skip: axis {quoted(axis)} has no label {quoted(label)}"
                self._problems.add(place, message, hint)

    def _remove_left_out(self, network: nx.MultiDiGraph[str]) -> None:
        """Remove the nodes that are left out, and those that need them."""
        left_out = {item.node for item in self._left_out}
        dependents = {name for node in left_out for name in nx.descendants(network, node)}
        for name in (name for name in network if name in dependents - left_out):
            missing = sorted(set(network.predecessors(name)) & (left_out | dependents))
            reason = f"no input from {', '.join(missing)}"
            self._left_out.append(LeftOut(name, reason))
        network.remove_nodes_from(left_out | dependents)
