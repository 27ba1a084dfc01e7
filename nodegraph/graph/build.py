"""Spec + registry + choices -> typed graph; every check happens here, and all are told at once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, version

from nodegraph.collection import no_collection
from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.axes import check_fixed, spread
from nodegraph.graph.choices import Choices, Names
from nodegraph.graph.leaks import check_leaks
from nodegraph.graph.methods import Chosen, choose
from nodegraph.graph.model import Gather, Graph, GraphNode, LeftOut, Method, sources_of
from nodegraph.graph.order import sorted_names
from nodegraph.graph.settings import SettingsReader
from nodegraph.graph.wiring import Wirer, dependencies
from nodegraph.registry import Registry
from nodegraph.spec.axes import is_label
from nodegraph.spec.parts import GraphSpec, NodeSpec, Reference


@no_collection()
def build(spec: GraphSpec, registry: Registry, choices: Choices | None = None) -> Graph:
    """Return the typed graph that a spec describes.

    Raises
    ------
    GraphError
        With every mistake: unknown names, wrong settings, misfits, cycles, leaks.
    """
    problems = Problems(spec.problems)
    graph = _Builder(spec, registry, choices or Choices(), problems).build()
    problems.raise_any()
    check_leaks(graph, problems)
    problems.raise_any()
    return graph


class _Builder:
    def __init__(
        self, spec: GraphSpec, registry: Registry, choices: Choices, problems: Problems
    ) -> None:
        self._spec = spec
        self._registry = registry
        self._problems = problems
        self._choices = choices
        self._names = Names(spec, choices, problems)
        self._settings = SettingsReader(self._names, registry, problems)
        self._chosen = {n: choose(one, registry, problems) for n, one in spec.nodes.items()}
        for name, one in spec.nodes.items():
            if one.has_alternatives:
                self._names.add_alternatives(name, tuple(m.label for m in self._chosen[name]))
        self._nodes: dict[str, GraphNode] = {}
        self._wirer = Wirer(spec, self._nodes, problems)
        self._left_out: list[LeftOut] = []
        self._incomplete: set[str] = set()  # nodes that may lack an axis because of a mistake

    def build(self) -> Graph:
        wires = {name: list(dependencies(self._chosen[name])) for name in self._spec.nodes}
        for name in sorted_names(wires, self._problems):
            self._nodes[name] = self._node(self._spec.nodes[name], self._chosen[name])
        self._names.check_choices()
        self._check_references()
        self._check_skip()
        self._check_requires()
        kept = _without_left_out(self._nodes, self._left_out)
        return Graph(
            self._spec,
            self._registry,
            self._names.axes,
            kept,
            self._names.inputs,
            self._choices,
            tuple(self._left_out),
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
        self._check_stages(spec.name, found.values(), axes.gathered)
        return GraphNode(
            spec.name, spec.place, found, spec.has_alternatives, axes.axes, axes.gathered
        )

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
            for written in chosen.settings.values():
                for variable in written.variables():
                    self._names.axis_of(variable)
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
        )

    def _check_stages(
        self, name: str, methods: Iterable[Method], gathered: tuple[str, ...]
    ) -> None:
        for fed in (fed for method in methods for fed in method.inputs.values()):
            if isinstance(fed, Gather) and fed.axis in gathered:
                message = (
                    f"{name}: port {fed.axis!r} is an axis here, and gathers another of its name"
                )
                place = next(iter(fed.sources.values())).place
                self._problems.add(place, message, f"rename the axis {fed.axis!r}")

    def _check_fixed(self, name: str, method: Method) -> None:
        for fed in method.inputs.values():
            for source in sources_of(fed):
                if source.node in self._incomplete:
                    continue
                reason = check_fixed(source, self._nodes, self._names.axes, self._problems)
                if reason:
                    self._left_out.append(LeftOut(name, reason))

    def _check_references(self) -> None:
        outputs = (*self._spec.outputs.values(), *self._spec.known, *self._spec.report)
        for reference in outputs:
            where = _section_of(reference, self._spec)
            self._wirer.source(reference, None, where)

    def _check_skip(self) -> None:
        for item in self._spec.skip:
            unknown = [axis for axis in item.labels if axis not in self._names.axes]
            for axis in unknown:
                hint = nearest(axis, self._names.axes, what="axes")
                self._problems.add(item.place, f"skip: no axis {axis!r}", hint)
            if unknown:
                continue
            for axis, labels in item.labels.items():
                self._check_skip_labels(item.place, axis, labels)
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

    def _check_requires(self) -> None:
        if not self._spec.requires:
            return
        from packaging.requirements import InvalidRequirement, Requirement

        for text, place in self._spec.requires:
            try:
                wanted = Requirement(text)
            except InvalidRequirement:
                hint = "write a package as pip takes it: my-plugin>=1.2"
                self._problems.add(place, f"requires: {text!r} is not a package", hint)
                continue
            found = _version(wanted.name)
            if found is None or not wanted.specifier.contains(found, prereleases=True):
                has = f"{found} is installed" if found else "it is not installed"
                self._problems.add(place, f"requires {text}, but {has}", f"pip install '{text}'")


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _gathers(method: Method) -> bool:
    return any(isinstance(fed, Gather) for fed in method.inputs.values())


def _section_of(reference: Reference, spec: GraphSpec) -> str:
    if reference in spec.report:
        return "report"
    return "known" if reference in spec.known else "outputs"


def _without_left_out(
    nodes: Mapping[str, GraphNode], left_out: list[LeftOut]
) -> dict[str, GraphNode]:
    """Leave out the nodes of which a label is gone, and whatever needs them."""
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
