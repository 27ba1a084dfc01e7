"""Which axes a node has, and which its gathering ports take together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import prod

from nodegraph.errors import Place, Problems, nearest
from nodegraph.graph.model import Axis, Gather, GraphNode, Method, sources_of
from nodegraph.graphfile.spec import NodeSpec, Reference


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


MOST = 5_000_000
_ENDLESS = 10**18


class Sizes:
    """Counts the combinations of a graph's nodes, and refuses more than a run could hold."""

    def __init__(self, axes: Mapping[str, Axis], problems: Problems) -> None:
        self._axes = axes
        self._problems = problems
        self._total = 0
        self._largest = 0
        self._where: tuple[GraphNode, tuple[str, ...]] | None = None

    def add(self, node: GraphNode, nodes: Mapping[str, GraphNode]) -> None:
        """Count a node's own combinations, or those that it takes together if they are more."""
        count = self._count(node.axes) if node.axes else 1
        gathered = 1
        if node.gathered:
            gathered = max(self._gathered(fed, node, nodes) for fed in _gathers(node))
            count *= gathered
        self._total += count
        if count > self._largest:
            along = (*node.axes, *node.gathered) if gathered > 1 else node.axes
            self._largest, self._where = count, (node, along)

    def can_be_run(self) -> bool:
        """Whether there are few enough; else note where most of them come from."""
        if self._total <= MOST or self._where is None:
            return True
        node, axes = self._where
        sizes = " x ".join(f"{axis} ({len(self._axes[axis].labels):,})" for axis in axes)
        self._problems.add(
            node.place,
            f"{node.name}: {_shown(self._largest)} combinations, {sizes}; "
            f"a graph may have {MOST:,}, and this one has {_shown(self._total)}",
            "run fewer labels, as with --axis or --only, or leave an axis out",
        )
        return False

    def _gathered(self, fed: Gather, node: GraphNode, nodes: Mapping[str, GraphNode]) -> int:
        sources = fed.sources.values()
        free = ([a for a in axes_of(one, nodes) if a in node.gathered] for one in sources)
        return sum(map(self._count, free))

    def _count(self, axes: Iterable[str]) -> int:
        return prod(len(self._axes[axis].labels) for axis in axes)


def _shown(count: int) -> str:
    return f"{count:,}" if count < _ENDLESS else "endless"


def _gathers(node: GraphNode) -> Iterable[Gather]:
    methods = node.methods.values()
    return (fed for one in methods for fed in one.inputs.values() if isinstance(fed, Gather))
