"""Which axes a node has, and which its gathering ports take together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.model import Axis, Gather, GraphNode, Method, sources_of
from nodegraph.spec.parts import NodeSpec, Reference


@dataclass(frozen=True)
class Spread:
    """The axes that a node has, and those that it gathers."""

    axes: tuple[str, ...]
    gathered: tuple[str, ...]


def spread(
    spec: NodeSpec,
    methods: Iterable[Method],
    nodes: Mapping[str, GraphNode],
    order: Iterable[str],
    problems: Problems,
) -> Spread:
    """Return the axes of a node from those of its settings and of what feeds it.

    Plain ports and settings give the node their axes. What a gathering port's source has beyond
    these is gathered; where ``over`` is given, only the axes that it names, and the rest stay
    the node's own.
    """
    matched = {spec.name} if spec.has_alternatives else set()
    offered: set[str] = set()
    for method in methods:
        matched.update(method.settings.axes)
        for fed in method.inputs.values():
            into = offered if isinstance(fed, Gather) else matched
            for source in sources_of(fed):
                into.update(axes_of(source, nodes))
    free = offered - matched
    over = free if spec.over is None else _over(spec, spec.over, matched, free, problems)
    ordered = [name for name in order if name in matched | free]
    return Spread(
        tuple(name for name in ordered if name in matched or name not in over),
        tuple(name for name in ordered if name in over),
    )


def axes_of(source: Reference, nodes: Mapping[str, GraphNode]) -> tuple[str, ...]:
    """Return the axes of a source that are not fixed."""
    node = nodes.get(source.node)
    return tuple(name for name in node.axes if name not in source.at) if node else ()


def check_fixed(
    source: Reference, nodes: Mapping[str, GraphNode], axes: Mapping[str, Axis], problems: Problems
) -> str:
    """Note ``at`` that names no axis or label; return why the source is left out, if it is."""
    node = nodes.get(source.node)
    reason = ""
    for name, label in source.at.items() if node else ():
        if node is not None and name not in node.axes:
            there = nearest(name, node.axes, what=f"axes of {source.node}")
            problems.add(source.place, f"{source.node!r} has no axis {name!r}", there)
        elif label in axes[name].removed:
            reason = f"made of {name}={label}, which the command has removed"
        elif label not in axes[name].labels and axes[name].labels:
            there = nearest(label, axes[name].labels, what="labels")
            problems.add(source.place, f"axis {name!r} has no label {label!r}", there)
    return reason


def _over(
    spec: NodeSpec,
    over: tuple[tuple[str, Place], ...],
    matched: set[str],
    free: set[str],
    problems: Problems,
) -> set[str]:
    for name, place in over:
        if name in matched:
            message = f"{spec.name}: {name!r} is an axis of its plain ports or settings"
            problems.add(place, message, "such an axis is matched and cannot be gathered")
        elif name not in free:
            there = nearest(name, sorted(free), what="axes that can be gathered")
            problems.add(place, f"{spec.name}: no axis {name!r} to gather", there)
    return {name for name, _ in over} & free
