"""How many combinations a graph has: counted before anything is done for each of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import prod

from nodegraph.errors import Problems
from nodegraph.graph.axes import axes_of
from nodegraph.graph.model import Axis, Gather, GraphNode

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
