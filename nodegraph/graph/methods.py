"""``use`` and ``alternatives`` -> the installed nodes behind them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from operator import attrgetter

from nodegraph.errors import Place, Problem, Problems, UnknownNodeError, nearest
from nodegraph.graph.model import asked, passing
from nodegraph.graphfile.spec import GraphSpec, MethodSpec, NodeSpec, Wiring, Written
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registered, Registry

PASS = "pass"


@dataclass(frozen=True)
class Chosen:
    """A method of a node with the wiring and settings that it gets, shared ones included.

    ``found`` is None where no installed node has the name; the mistake is noted already.
    """

    label: str
    found: Registered | None
    place: Place
    wiring: Wiring
    settings: Mapping[str, Written]


def choose(
    spec: NodeSpec, registry: Registry, graphs: Mapping[str, Registered], problems: Problems
) -> list[Chosen]:
    """Return the methods of a node; what is not installed is noted with its line.

    Parameters
    ----------
    spec
    registry
    graphs
        For labels of which the method is a graph, what stands for that graph.
    problems
    """
    found = list(_unfolded(spec, registry, problems))
    chosen = _replaced(found, spec.methods)
    siblings = [one for one in chosen.values() if one.use != PASS]
    if not spec.has_alternatives and spec.methods and spec.methods[0].use == PASS:
        problems.add(spec.methods[0].place, "'pass' stands only among alternatives")
    made = {one.label: graphs.get(one.label) or _found(one, registry, problems) for one in siblings}
    _check_family(spec, made, problems)
    first = next((one for one in made.values() if one is not None), None)
    for one in chosen.values():
        if one.use == PASS and spec.has_alternatives:
            _check_passing(one, first, bool(siblings), problems)
    return [
        _chosen(spec, one, made[one.label] if one.use != PASS else _passing(first))
        for one in chosen.values()
    ]


def _unfolded(spec: NodeSpec, registry: Registry, problems: Problems) -> Iterator[MethodSpec]:
    for method in spec.methods:
        if not is_family(method.use):
            yield method
            continue
        family = registry.family(method.use[:-2])
        kept = {label: one for label, one in family.items() if not one.node.deprecated}
        if not family:
            hint = nearest(method.use, [f"{name}.*" for name in registry.families])
            problems.add(method.place, f"no node of the family {method.use!r}", hint)
        elif not kept:
            hint = "; ".join(f"{one.node.name}: {one.node.deprecated}" for one in family.values())
            problems.add(method.place, f"all nodes of {method.use!r} are deprecated", hint)
        for label, one in kept.items():
            yield replace(method, label=label, use=one.full_name)


def is_family(use: str) -> bool:
    """Whether a ``use`` names all methods of a family."""
    return use.endswith(".*")


def _replaced(methods: list[MethodSpec], written: Sequence[MethodSpec]) -> dict[str, MethodSpec]:
    """Let a label written by itself stand for the family's method of that label."""
    if len(methods) == 1:
        return {methods[0].label: methods[0]}
    own = {id(one) for one in written}
    chosen: dict[str, MethodSpec] = {}
    for one in methods:
        if id(one) in own or id(chosen.get(one.label)) not in own:
            chosen[one.label] = one
    return chosen


def _found(method: MethodSpec, registry: Registry, problems: Problems) -> Registered | None:
    if not method.use:
        return None
    try:
        return registry.find(method.use)
    except UnknownNodeError as error:
        message, _, instead = str(error).partition("; ")
        problems.add(method.place, message, instead)
        return None


def _check_passing(
    passing: MethodSpec, sibling: Registered | None, has_siblings: bool, problems: Problems
) -> None:
    if not has_siblings:
        problems.add(passing.place, "'pass' needs another alternative, whose ports it takes")
    elif sibling is not None:
        first = next(iter(asked(sibling.node)), None)
        if first is None:
            message = f"'pass' hands on an input, and {sibling.node.name} has none"
            problems.add(passing.place, message)
        elif first.across:
            message = f"'pass' hands on one value, and {sibling.node.name} gathers several"
            problems.add(passing.place, message)


def _passing(sibling: Registered | None) -> Registered | None:
    return Registered(passing(sibling.node), "nodegraph") if sibling else None


def _chosen(spec: NodeSpec, method: MethodSpec, found: Registered | None) -> Chosen:
    if found is not None and method.is_graph:
        # what is shared has gone to the nodes inside already
        return Chosen(method.label, found, method.place, method.wiring, method.settings)
    if found is None or method.use != PASS:
        wiring = shared_and_own(spec, method, found.node if found else None)
        settings = {**spec.settings, **method.settings}
        return Chosen(method.label, found, method.place, wiring, settings)
    # the siblings' other ports and settings do not concern what only hands on
    first = found.node.inputs[0].name if found.node.inputs else ""
    shared = _by_port(spec.wiring, found.node)
    wiring = {port: one for port, one in shared.items() if port == first}
    wiring |= _by_port(method.wiring, found.node)
    return Chosen(method.label, found, method.place, wiring, method.settings)


def shared_and_own(spec: NodeSpec, method: MethodSpec, node: Node | None) -> Wiring:
    """Return what feeds a method: what the node's methods share, its own on top."""
    return {**_by_port(spec.wiring, node), **_by_port(method.wiring, node)}


def _by_port(wiring: Wiring, node: Node | None) -> Wiring:
    """Name the first port, so that a method's own wiring replaces the shared one."""
    if node is None or "" not in wiring or not asked(node):
        return wiring
    return {port or asked(node)[0].name: one for port, one in wiring.items()}


def _check_family(
    spec: NodeSpec, made: Mapping[str, Registered | None], problems: Problems
) -> None:
    if not any(is_family(one.use) for one in spec.methods):
        return
    nodes = [one.node for one in made.values() if one is not None]
    for node in nodes[1:]:
        if _promise(node) != _promise(nodes[0]):
            message = f"{node.name!r} cannot stand beside {nodes[0].name!r}"
            shapes = f"{_shape(node)} differs from {_shape(nodes[0])}"
            problems.add(spec.place, message, f"{shapes}; list the methods by name instead")


def _promise(node: Node) -> tuple[object, ...]:
    required = {port.name: port for port in asked(node) if not port.optional}
    return (*sorted(required.items()), node.outputs[0].truth, node.outputs[0].type)


def _shape(node: Node) -> str:
    required = ", ".join(str(port) for port in asked(node) if not port.optional)
    return f"({required}) -> {node.outputs[0].type.__name__}"


def check_requires(spec: GraphSpec, problems: Problems) -> None:
    """Note every required package that is not installed in a version that will do."""
    if not spec.requires:
        return
    from packaging.requirements import InvalidRequirement, Requirement

    for text, place in spec.requires:
        try:
            wanted = Requirement(text)
        except InvalidRequirement:
            hint = "write a package as pip takes it: my-plugin>=1.2"
            problems.add(place, f"requires: {text!r} is not a package", hint)
            continue
        here = attrgetter("marker")(wanted)  # what stands behind the semicolon
        if here is not None and not here.evaluate():
            continue
        found = _version(wanted.name)
        if found is None or not wanted.specifier.contains(found, prereleases=True):
            has = f"{found} is installed" if found else "it is not installed"
            problems.add(place, f"requires {text}, but {has}", f"pip install '{text}'")


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def notices(
    nodes: Iterable[NodeSpec],
    chosen: Mapping[str, Iterable[Chosen]],
    labels: Mapping[str, Collection[object]],
    registry: Registry,
) -> tuple[Problem, ...]:
    """Return what is deprecated in a graph, each with its place and what to use instead.

    Parameters
    ----------
    nodes
    chosen
        The methods of each node.
    labels
        Of each node with alternatives, the labels that are run.
    registry
    """
    found: list[Problem] = []
    for spec in nodes:
        for one in chosen[spec.name]:
            if not spec.has_alternatives or one.label in labels[spec.name]:
                found += _of_method(spec.name, one)
        found += _of_families(spec, registry)
    return tuple(sorted(dict.fromkeys(found), key=lambda one: one.place))


def _of_method(name: str, chosen: Chosen) -> Iterator[Problem]:
    if chosen.found is None:
        return
    node = chosen.found.node
    where = f"{name} ({chosen.label})" if chosen.label else name
    if node.deprecated:
        yield Problem(chosen.place, f"{where}: {node.name} is deprecated", node.deprecated)
    for setting, written in chosen.settings.items():
        described = node.settings.get(setting)
        if described is not None and described.deprecated:
            message = f"{where}: setting {setting!r} of {node.name} is deprecated"
            yield Problem(written.place, message, described.deprecated)


def _of_families(spec: NodeSpec, registry: Registry) -> Iterator[Problem]:
    for method in spec.methods:
        if is_family(method.use):
            for one in registry.family(method.use[:-2]).values():
                if one.node.deprecated:
                    name = one.node.name
                    message = f"{spec.name}: {method.use} leaves {name} out, which is deprecated"
                    yield Problem(method.place, message, f"{one.node.deprecated}; or list {name}")
