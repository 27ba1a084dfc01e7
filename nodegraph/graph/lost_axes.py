"""Axes that a graph loses with the methods that the command leaves out.

A setting that only some methods of a node have may stand for an axis, which the node has through
these methods alone. A command that keeps none of them must still get a graph: wherever the file
names such an axis, the name is dropped, with a notice.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TypeVar

from nodegraph.errors import Place, Problem
from nodegraph.graph.methods import ResolvedMethod
from nodegraph.graph.model import Gather, GraphNode, Method, Settings
from nodegraph.graphfile.spec import Reference, SkipSpec
from nodegraph.node.ports import ColumnOf

_Reference = TypeVar("_Reference", bound=Reference)


class LostAxes:
    """The axes that nodes have lost, and where their names were dropped."""

    def __init__(self) -> None:
        self._lost: dict[str, frozenset[str]] = {}  # by node; most nodes have lost none
        self._places: dict[str, list[Place]] = {}

    def add(self, node: GraphNode, nodes: Mapping[str, GraphNode], every: Iterable[Method]) -> None:
        """Note what a node has lost.

        Parameters
        ----------
        node
            With the methods that are kept.
        nodes
            Those that feed it, noted already.
        every
            Its methods, those that are left out included.
        """
        axes: set[str] = set()
        for method in every:
            axes.update(method.settings.axes)
            for source in method.references():
                if source.node in nodes and (nodes[source.node].axes or self._of(source.node)):
                    axes |= {*nodes[source.node].axes, *self._of(source.node)} - source.at.keys()
        if lost := axes.difference(node.axes, node.gathered):
            self._lost[node.name] = frozenset(lost)

    def without(self, source: _Reference) -> _Reference:
        """Return a reference that fixes none of them."""
        lost = self._of(source.node) & source.at.keys()
        for axis in lost:
            self._drop(axis, source.place)
        at = {axis: label for axis, label in source.at.items() if axis not in lost}
        return replace(source, at=at) if lost else source

    def rewired(self, methods: Iterable[ResolvedMethod]) -> list[ResolvedMethod]:
        """Return methods whose references fix none of them."""
        return [
            method.rewired(self.without)
            if self._lost and any(map(self._of, (source.node for source in method.references())))
            else method
            for method in methods
        ]

    def without_names(self, node: GraphNode) -> GraphNode:
        """Return a node whose lists of axes and columns name none of them."""
        if not self._lost:
            return node
        methods = {label: self._without_names(node, each) for label, each in node.methods.items()}
        return replace(node, methods=methods) if methods != node.methods else node

    def explains(self, item: SkipSpec, nodes: Iterable[GraphNode]) -> bool:
        """Return whether a node would have the axes of a rule, which is dropped then."""
        for node in nodes:
            lost = self._of(node.name) & item.labels.keys()
            if lost and item.labels.keys() <= {*node.axes, *lost}:
                for axis in lost:
                    self._drop(axis, item.place)
                return True
        return False

    def notices(self) -> Iterator[Problem]:
        """Yield a notice for each axis that was dropped."""
        for axis, places in self._places.items():
            first, *more = sorted(set(places))
            also = f", and in {len(more)} more places" if more else ""
            yield Problem(
                first,
                f"the axis {axis!r} is dropped here{also}: no method that is kept depends on it",
                "keep such a method with --only",
            )

    def _of(self, name: str) -> frozenset[str]:
        return self._lost.get(name, frozenset())

    def _without_names(self, node: GraphNode, method: Method) -> Method:
        for name, setting in method.node.settings.items():
            mark = setting.names
            if isinstance(mark, ColumnOf) and mark.or_axis:
                feed = method.inputs.get(mark.port)
                lost = self._behind(feed, node) if isinstance(feed, Gather) else {}
                for values in method.settings.values.values():
                    value = values[name]
                    if isinstance(value, (list, tuple)) and (gone := lost.keys() & set(value)):
                        for each in gone:
                            self._drop(lost[each], method.places.get(name, method.place))
                        method = replace(method, settings=_without(method.settings, name, gone))
        return method

    def _behind(self, feed: Gather, node: GraphNode) -> Mapping[str, str]:
        """Return the axes that a port does not gather, by the name that its node would see."""
        lost = {
            axis
            for source in feed.sources.values()
            for axis in self._of(source.node) - source.at.keys()
        }
        return {node.local_name(axis): axis for axis in lost.difference(node.gathered)}

    def _drop(self, axis: str, place: Place) -> None:
        self._places.setdefault(axis, []).append(place)


def _without(settings: Settings, name: str, gone: Iterable[str]) -> Settings:
    def kept(values: Mapping[str, object]) -> Mapping[str, object]:
        value = values[name]
        if not isinstance(value, (list, tuple)):
            return values
        return {**values, name: type(value)(each for each in value if each not in set(gone))}

    return Settings(
        settings.axes,
        {labels: kept(values) for labels, values in settings.values.items()},
        {labels: kept(values) for labels, values in settings.shown.items()},
    )
