"""What a graph uses that its author has replaced by something better, and where."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

from nodegraph.errors import Problem
from nodegraph.graph.methods import Chosen, is_family
from nodegraph.registry import Registry
from nodegraph.spec.parts import NodeSpec


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
