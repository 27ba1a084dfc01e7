"""Flat spec + registry + choices -> typed graph: nodes, axes, wires, and every check of these."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.axes import Sizes, check_fixed, spread
from nodegraph.graph.choices import Choices, Names
from nodegraph.graph.methods import Chosen, check_requires, choose, notices
from nodegraph.graph.model import Flat, Gather, Graph, GraphNode, LeftOut, Method, sources_of
from nodegraph.graph.settings import SettingsReader
from nodegraph.graph.wiring import Wirer, dependencies, sorted_names
from nodegraph.graphfile.axes import is_label
from nodegraph.graphfile.spec import NodeSpec, Reference
from nodegraph.plugin.registry import Registry


class Builder:
    """Builds one graph, and notes every mistake that there is in it.

    Parameters
    ----------
    flat
    registry
    choices
    problems
        Where mistakes are noted. A graph that has any is good for nothing but to be looked at.
    """

    def __init__(
        self, flat: Flat, registry: Registry, choices: Choices, problems: Problems
    ) -> None:
        spec = flat.spec
        self._flat = flat
        self._spec = spec
        self._registry = registry
        self._problems = problems
        self._choices = choices
        self._names = Names(spec, flat.ports, choices, problems)
        self._sizes = Sizes(self._names.axes, problems)
        self._settings = SettingsReader(self._names, registry, problems)
        self._chosen = {
            name: choose(one, registry, flat.graphs.get(name, {}), problems)
            for name, one in spec.nodes.items()
        }
        for name, one in spec.nodes.items():
            if one.has_alternatives:
                self._names.add_alternatives(name, tuple(m.label for m in self._chosen[name]))
        self._nodes: dict[str, GraphNode] = {}
        self._wirer = Wirer(spec, self._nodes, self._names, problems)
        self._left_out: list[LeftOut] = []
        self._incomplete: set[str] = set()  # nodes that may lack an axis because of a mistake

    def build(self) -> Graph:
        """Return the graph."""
        wires = {name: list(dependencies(self._chosen[name])) for name in self._spec.nodes}
        for name in sorted_names(wires, self._problems):
            self._nodes[name] = self._node(self._spec.nodes[name], self._chosen[name])
        self._check_feeds()
        self._check_references()
        self._names.check_choices()
        self._check_skip()
        check_requires(self._spec, self._problems)
        self._settings.fill(in_full=self._sizes.can_be_run())
        kept = _without_left_out(self._nodes, self._left_out)
        return Graph(
            self._spec,
            self._registry,
            self._names.axes,
            kept,
            self._names.inputs,
            self._choices,
            tuple(self._left_out),
            notices(
                self._spec.nodes.values(),
                self._chosen,
                {name: axis.labels for name, axis in self._names.axes.items()},
                self._registry,
            ),
        )

    def _node(self, spec: NodeSpec, chosen: list[Chosen]) -> GraphNode:
        kept = self._names.axes[spec.name].labels if spec.has_alternatives else ("",)
        methods = [self._method(spec, one) for one in chosen]
        found = {one.label: one for one in methods if one is not None and one.label in kept}
        gathers = any(_gathers(one) for one in found.values())
        if spec.over and found and not gathers:
            self._problems.add(spec.over[0][1], f"{spec.name}: 'over' needs a port that gathers")
        for method in found.values():
            self._check_fixed(spec.name, method)
        if not all(map(self._is_complete, chosen)):
            self._incomplete.add(spec.name)
        told = self._problems if gathers and spec.name not in self._incomplete else Problems()
        axes = spread(spec, found.values(), self._nodes, self._names.axes, told)
        node = GraphNode(
            spec.name,
            spec.place,
            found,
            spec.has_alternatives,
            axes.axes,
            axes.gathered,
            spec.prefix,
        )
        if gathers:
            self._check_gathered(node)
        self._sizes.add(node, self._nodes)
        return node

    def _is_complete(self, chosen: Chosen) -> bool:
        """Whether all that gives a method its axes could be read."""
        if chosen.found is None:
            return False
        for name, written in chosen.settings.items():
            variables = set(written.variables())
            if variables and name not in chosen.found.node.settings:
                return False
            if variables & self._names.unknown:
                return False
        feeds = {name for name, _ in dependencies([chosen])}
        return feeds <= self._nodes.keys() and not feeds & self._incomplete

    def _method(self, spec: NodeSpec, chosen: Chosen) -> Method | None:
        where = f"{spec.name} ({chosen.label})" if chosen.label else spec.name
        if chosen.found is None:
            self._names.use(chosen.settings.values())
            self._wirer.look_up(where, chosen)
            return None
        node = chosen.found.node
        return Method(
            label=chosen.label,
            node=node,
            plugin=chosen.found.plugin,
            distribution=chosen.found.distribution,
            inputs=self._wirer.wire(where, chosen, node),
            settings=self._settings.read(where, chosen, node),
            place=chosen.place,
            places={name: self._names.place(one) for name, one in chosen.settings.items()},
        )

    def _check_gathered(self, node: GraphNode) -> None:
        """Note axes that a node would see under one name."""
        seen = [node.inside(axis) for axis in node.gathered]
        for axis in (axis for axis in dict.fromkeys(seen) if seen.count(axis) > 1):
            message = f"{node.name}: gathers two axes that are called {axis!r} in there"
            self._problems.add(node.place, message, f"rename one of the axes {axis!r}")
        for method in node.methods.values():
            for fed in method.inputs.values():
                if isinstance(fed, Gather) and fed.axis in seen:
                    message = f"port {fed.axis!r} is an axis here, and gathers another of its name"
                    place = next(iter(fed.sources.values())).place
                    instead = f"rename the axis {fed.axis!r}"
                    self._problems.add(place, f"{node.name}: {message}", instead)

    def _check_fixed(self, name: str, method: Method) -> None:
        for fed in method.inputs.values():
            for source in sources_of(fed):
                if reason := self._fixes(source):
                    self._left_out.append(LeftOut(name, reason))

    def _fixes(self, source: Reference) -> str:
        """Check the axes that a reference fixes; return why it is left out, if it is."""
        if not source.at or source.node in self._incomplete:
            return ""
        return check_fixed(source, self._nodes, self._names.axes, self._problems)

    def _check_feeds(self) -> None:
        """Check what is fed to, and set for, the graphs that nodes use."""
        for feed in self._flat.feeds:
            self._wirer.source(feed.source, feed.port, feed.where)
            self._fixes(feed.source)
        self._names.use(self._flat.given)

    def _check_references(self) -> None:
        spec = self._spec
        sections = {"outputs": spec.outputs.values(), "known": spec.known, "report": spec.report}
        for section, references in sections.items():
            for reference in references:
                self._wirer.source(reference, None, section)
                self._fixes(reference)

    def _check_skip(self) -> None:
        for item in self._spec.skip:
            unknown = [axis for axis in item.labels if axis not in self._names.axes]
            for axis in unknown:
                hint = nearest(axis, self._names.axes, what="axes")
                self._problems.add(item.place, f"skip: no axis {axis!r}", hint)
            for axis, labels in item.labels.items():
                if axis not in unknown:
                    self._check_skip_labels(item.place, axis, labels)
            if unknown:
                continue
            fits = any(set(item.labels) <= set(node.axes) for node in self._nodes.values())
            if not fits and not self._incomplete:
                together = " and ".join(item.labels)
                self._problems.add(item.place, f"skip: no node has the axes {together} together")

    def _check_skip_labels(self, place: Place, axis: str, labels: Iterable[object]) -> None:
        there = self._names.axes[axis]
        for label in labels:
            if not is_label(label) or label not in {*there.labels, *there.removed}:
                hint = nearest(label, there.labels, what="labels")
                self._problems.add(place, f"skip: axis {axis!r} has no label {label!r}", hint)


def _gathers(method: Method) -> bool:
    return any(isinstance(fed, Gather) for fed in method.inputs.values())


def _without_left_out(
    nodes: Mapping[str, GraphNode], left_out: list[LeftOut]
) -> dict[str, GraphNode]:
    """Leave out the nodes of which a label is gone, and whatever needs them."""
    if not left_out:
        return dict(nodes)
    gone = {one.node for one in left_out}
    kept: dict[str, GraphNode] = {}
    for name, node in nodes.items():
        needs = sorted({one.node for m in node.methods.values() for one in _needed(m)} & gone)
        if needs and name not in gone:
            gone.add(name)
            left_out.append(LeftOut(name, f"it needs {', '.join(needs)}, which is left out"))
        if name not in gone:
            kept[name] = node
    return kept


def _needed(method: Method) -> Iterable[Reference]:
    return (source for fed in method.inputs.values() for source in sources_of(fed))
