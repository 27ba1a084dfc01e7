"""Resolve ``use`` and ``alternatives`` to installed nodes."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from operator import attrgetter
from typing import TypeVar

from nodegraph.errors import Place, Problem, Problems, UnknownNodeError, nearest, quoted
from nodegraph.graph.model import Axis, method_name, sources_of
from nodegraph.graph.pass_through import pass_beside, public_inputs
from nodegraph.graphfile.keys import PASS
from nodegraph.graphfile.spec import (
    FIRST,
    GraphSpec,
    MethodSpec,
    NodeSpec,
    Reference,
    Wiring,
    Written,
    rewired,
)
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registered, Registry

_Reference = TypeVar("_Reference", bound=Reference)


@dataclass(frozen=True)
class ResolvedMethod:
    """A method of a node with its wiring and settings, those shared by the methods included.

    Attributes
    ----------
    registered : Registered or None
        None if no installed node has the name; the error is recorded.
    """

    label: str
    registered: Registered | None
    place: Place
    wiring: Wiring
    settings: Mapping[str, Written]

    def references(self) -> Iterator[Reference]:
        """Yield every reference that feeds the method."""
        for feed in self.wiring.values():
            yield from sources_of(feed)

    def with_first_labels(self, axes: Mapping[str, Axis]) -> ResolvedMethod:
        """Return the method with each `FIRST` in its wiring replaced by the label."""
        if not any(FIRST in source.at.values() for source in self.references() if source.at):
            return self  # as most are
        change = partial(at_first_labels, axes=axes)
        wiring = {name: rewired(feed, change) for name, feed in self.wiring.items()}
        return replace(self, wiring=wiring)


def at_first_labels(source: _Reference, axes: Mapping[str, Axis]) -> _Reference:
    """Return a reference with each `FIRST` in it replaced by the label."""
    first = {name: axes[name].labels[0] for name in source.at if name in axes and axes[name].labels}
    at = {name: first.get(name, at) if at == FIRST else at for name, at in source.at.items()}
    return replace(source, at=at)


def resolve_methods(
    spec: NodeSpec, registry: Registry, graphs: Mapping[str, Registered], problems: Problems
) -> list[ResolvedMethod]:
    """Return the methods of a node; a ``use`` that is not installed is recorded.

    Parameters
    ----------
    spec
    registry
    graphs
        Nodes that stand for graph files, by the label of the method that uses each.
    problems
    """
    if len(spec.methods) == 1 and not graphs:
        method = spec.methods[0]
        if method.use != PASS and not is_family(method.use):  # as most nodes have
            return [_resolved(spec, method, _find(method, registry, problems), ())]
    methods = _merged(list(_expanded(spec, registry, problems)), spec.methods)
    siblings = [method for method in methods if method.use != PASS]
    if not spec.has_alternatives and spec.methods and spec.methods[0].use == PASS:
        problems.add(spec.methods[0].place, "'pass' stands only among alternatives")
    registered = {
        method.label: graphs.get(method.label) or _find(method, registry, problems)
        for method in siblings
    }
    has_family = any(is_family(method.use) for method in spec.methods)
    if has_family:
        _check_family(spec, registered, problems)
    first = next((sibling for sibling in registered.values() if sibling is not None), None)
    if len(siblings) < len(methods):
        passing = Registered(pass_beside(first.node), "nodegraph") if first else None
        for method in methods:
            if method.use == PASS:
                registered[method.label] = passing
                if spec.has_alternatives:
                    _check_pass(method, first, bool(siblings), problems)
    listed = {method.label for method in spec.methods} if has_family else registered.keys()
    family = [each for label, each in registered.items() if label not in listed and each]
    return [
        _resolved(spec, method, registered[method.label], () if method.label in listed else family)
        for method in methods
    ]


def _expanded(spec: NodeSpec, registry: Registry, problems: Problems) -> Iterator[MethodSpec]:
    """Yield the methods of a node, those of a family one by one."""
    for method in spec.methods:
        if not is_family(method.use):
            yield method
            continue
        family = registry.family(method.use[:-2])
        current = {label: member for label, member in family.items() if not member.node.deprecated}
        if not family:
            hint = nearest(method.use, [f"{name}.*" for name in registry.families])
            problems.add(method.place, f"no node of the family {quoted(method.use)}", hint)
        elif not current:
            nodes = [member.node for member in family.values()]
            hint = "; ".join(f"{node.name}: {node.deprecated}" for node in nodes)
            problems.add(method.place, f"all nodes of {quoted(method.use)} are deprecated", hint)
        for label, member in current.items():
            yield replace(method, label=label, use=member.full_name)


def is_family(use: str) -> bool:
    """Whether a ``use`` names all methods of a family."""
    return use.endswith(".*")


def _merged(methods: list[MethodSpec], written: Sequence[MethodSpec]) -> list[MethodSpec]:
    """Replace a family's method by an explicit one of the same label."""
    if len(methods) == 1:
        return methods
    explicit = {id(method) for method in written}
    by_label: dict[str, MethodSpec] = {}
    for method in methods:
        if id(method) in explicit or id(by_label.get(method.label)) not in explicit:
            by_label[method.label] = method
    return list(by_label.values())


def _find(method: MethodSpec, registry: Registry, problems: Problems) -> Registered | None:
    if not method.use:
        return None
    if method.use.startswith("$"):
        message = f"'use' and 'alternatives' name nodes, not the value of {method.use}"
        instead = "to compare methods, list them in the node: alternatives: [x.a, x.b]"
        problems.add(method.place, message, instead)
        return None
    try:
        return registry.find(method.use)
    except UnknownNodeError as error:
        problems.add(method.place, error.message, error.hint)
        return None


def _check_pass(
    method: MethodSpec, sibling: Registered | None, has_siblings: bool, problems: Problems
) -> None:
    if not has_siblings:
        problems.add(method.place, "'pass' needs another alternative, whose ports it takes")
    elif sibling is not None:
        first = next(iter(public_inputs(sibling.node)), None)
        if first is None:
            message = f"'pass' hands on an input, and {sibling.node.name} has none"
            problems.add(method.place, message)
        elif first.across:
            message = f"'pass' hands on one value, and {sibling.node.name} gathers several"
            problems.add(method.place, message)


def _resolved(
    spec: NodeSpec,
    method: MethodSpec,
    registered: Registered | None,
    family: Collection[Registered],
) -> ResolvedMethod:
    wiring, settings = method.wiring, method.settings
    if registered is not None and method.use == PASS:
        # the siblings' other ports and settings do not concern a method that only passes on
        node = registered.node
        first = node.inputs[0].name if node.inputs else ""
        shared = _by_port(spec.wiring, node)
        own = _by_port(method.wiring, node)
        wiring = {**{port: feed for port, feed in shared.items() if port == first}, **own}
    elif registered is None or not method.is_graph:  # a graph's nodes already have what is shared
        wiring = shared_and_own(spec, method, registered.node if registered else None)
        settings = {**spec.settings, **method.settings}
        if registered is not None and family:
            # not every third-party method of a family has the settings that ours share
            known = {name for member in family for name in member.node.settings}
            absent = known - registered.node.settings.keys()
            settings = {name: value for name, value in settings.items() if name not in absent}
    return ResolvedMethod(method.label, registered, method.place, wiring, settings)


def shared_and_own(spec: NodeSpec, method: MethodSpec, node: Node | None) -> Wiring:
    """Return the references that feed a method: the shared ones, overridden by its own."""
    return {**_by_port(spec.wiring, node), **_by_port(method.wiring, node)}


def _by_port(wiring: Wiring, node: Node | None) -> Wiring:
    """Name the first port, so that a method's own wiring overrides the shared one."""
    if node is None or "" not in wiring or not (ports := public_inputs(node)):
        return wiring
    return {port or ports[0].name: feed for port, feed in wiring.items()}


def _check_family(
    spec: NodeSpec, registered: Mapping[str, Registered | None], problems: Problems
) -> None:
    nodes = [member.node for member in registered.values() if member is not None]
    for node in nodes[1:]:
        if _signature(node) != _signature(nodes[0]):
            message = f"{quoted(node.name)} cannot be an alternative to {quoted(nodes[0].name)}"
            shapes = f"{_signature_text(node)} differs from {_signature_text(nodes[0])}"
            problems.add(spec.place, message, f"{shapes}; list the methods by name instead")


def _signature(node: Node) -> tuple[object, ...]:
    """Return the ports and settings that the methods of a family have in common."""
    required = {port.name: port for port in public_inputs(node) if not port.optional}
    return (*sorted(required.items()), node.outputs[0].truth, node.outputs[0].type)


def _signature_text(node: Node) -> str:
    required = ", ".join(str(port) for port in public_inputs(node) if not port.optional)
    return f"({required}) -> {node.outputs[0].type.__name__}"


def check_requires(spec: GraphSpec, problems: Problems) -> None:
    """Record every required package that is missing or installed in another version."""
    if not spec.requires:
        return
    from packaging.requirements import InvalidRequirement, Requirement

    for text, place in spec.requires:
        try:
            requirement = Requirement(text)
        except InvalidRequirement:
            hint = "write a package as pip takes it: my-plugin>=1.2"
            problems.add(place, f"requires: {quoted(text)} is not a package", hint)
            continue
        condition = attrgetter("marker")(requirement)  # what follows a semicolon
        if condition is not None and not condition.evaluate():
            continue
        installed = installed_version(requirement.name)
        if not installed or not requirement.specifier.contains(installed, prereleases=True):
            state = f"{installed} is installed" if installed else "it is not installed"
            problems.add(place, f"requires {text}, but {state}", f"pip install '{text}'")


def installed_version(name: str) -> str:
    """Return the version of an installed package; empty if it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def deprecations(
    nodes: Iterable[NodeSpec],
    methods: Mapping[str, Iterable[ResolvedMethod]],
    labels: Mapping[str, Collection[object]],
    registry: Registry,
) -> tuple[Problem, ...]:
    """Return every use of something deprecated, with its place and what to use instead.

    Parameters
    ----------
    nodes
    methods
        The methods of each node.
    labels
        The labels that are run of each node with alternatives.
    registry
    """
    notices: list[Problem] = []
    for spec in nodes:
        for method in methods[spec.name]:
            if not spec.has_alternatives or method.label in labels[spec.name]:
                notices += _deprecated_in_method(spec.name, method)
        notices += _deprecated_in_families(spec, registry)
    return tuple(sorted(dict.fromkeys(notices), key=lambda notice: notice.place))


def _deprecated_in_method(name: str, method: ResolvedMethod) -> Iterator[Problem]:
    if method.registered is None:
        return
    node = method.registered.node
    where = method_name(name, method.label)
    if node.deprecated:
        yield Problem(method.place, f"{where}: {node.name} is deprecated", node.deprecated)
    for setting, written in method.settings.items():
        described = node.settings.get(setting)
        if described is not None and described.deprecated:
            message = f"{where}: setting {quoted(setting)} of {node.name} is deprecated"
            yield Problem(written.place, message, described.deprecated)


def _deprecated_in_families(spec: NodeSpec, registry: Registry) -> Iterator[Problem]:
    for method in spec.methods:
        if is_family(method.use):
            for member in registry.family(method.use[:-2]).values():
                if member.node.deprecated:
                    name = member.node.name
                    message = f"{spec.name}: {method.use} leaves out {name}, which is deprecated"
                    instead = f"{member.node.deprecated}; or list {name}"
                    yield Problem(method.place, message, instead)
