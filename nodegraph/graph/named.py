"""Settings that name columns, axes or labels of what a port gets: refused where there is none."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from nodegraph.errors import Problems, nearest
from nodegraph.graph.model import Gather, Graph, GraphNode, Method, sources_of
from nodegraph.ports import ColumnOf, LabelOf, Port
from nodegraph.spec.parts import Reference


def check_named(graph: Graph, problems: Problems) -> None:
    """Note settings that name a column, an axis or a label which is known not to be there."""
    for node in graph.nodes.values():
        for method in node.methods.values():
            for name, setting in method.node.settings.items():
                mark = setting.names
                if mark is not None and mark.port in method.inputs:
                    _Named(graph, node, method, name, mark.port, problems).check(mark)


def columns_of(ports: Iterable[Port]) -> tuple[str, ...]:
    """Return the columns of all tables that come from these; none if one does not declare its."""
    declared = [port.columns for port in ports]
    if not all(declared):
        return ()
    return tuple(dict.fromkeys(name for columns in declared for name in columns))


@dataclass(frozen=True)
class _Named:
    """A setting of a method, and what the port gets whose columns, axes or labels it names."""

    graph: Graph
    node: GraphNode
    method: Method
    setting: str
    port: str
    problems: Problems

    def check(self, mark: ColumnOf | LabelOf) -> None:
        if isinstance(mark, ColumnOf):
            self._check_columns(self._labels if mark.or_axis else {})
        else:
            self._check_labels(mark.axis)

    def _check_columns(self, axes: Iterable[str]) -> None:
        columns = columns_of(self._sources())
        what = ("axis or column", "axes and columns") if axes else ("column", "columns")
        known = (*axes, *columns)
        for values in self._values() if columns else ():
            for name in _texts(values, self.setting):
                if name not in known:
                    self._note(what[0], name, nearest(name, known, what=what[1]))

    def _check_labels(self, axis: str) -> None:
        every = tuple(label for labels in self._labels.values() for label in labels)
        for values in self._values():
            chosen = values.get(axis)
            there = self._labels.get(str(chosen), ()) if chosen is not None else every
            for name in _texts(values, self.setting):
                if there and name not in there:
                    self._note("label", name, nearest(name, there, what="labels"))

    def _note(self, what: str, name: str, there: str) -> None:
        label = self.method.label
        where = f"{self.node.name} ({label})" if label else self.node.name
        place = self.method.places.get(self.setting, self.method.place)
        message = f"{where}: {self.setting}: port {self.port!r} has no {what} {name!r}"
        self.problems.add(place, message, there)

    def _values(self) -> Iterable[Mapping[str, Any]]:
        return self.method.settings.values.values()

    @property
    def _fed(self) -> Reference | Gather:
        return self.method.inputs[self.port]

    def _sources(self) -> Iterator[Port]:
        """Yield the outputs that may feed the port."""
        for source in sources_of(self._fed):
            for method in self.graph.nodes[source.node].methods.values():
                yield method.node.output(source.port) or method.node.outputs[0]

    @cached_property
    def _labels(self) -> Mapping[str, tuple[str, ...]]:
        """The labels of each axis that the port gathers, as the node sees it.

        What the command has taken away is no mistake of who wrote the graph.
        """
        if not isinstance(self._fed, Gather):
            return {}
        found = {self._fed.axis: tuple(self._fed.sources)} if self._fed.axis else {}
        for source in sources_of(self._fed):
            for name in self.graph.nodes[source.node].axes:
                if name in self.node.gathered and name not in source.at:
                    axis = self.graph.axes[name]
                    found[self.node.inside(name)] = tuple(map(str, (*axis.labels, *axis.removed)))
        return found


def _texts(values: Mapping[str, Any], setting: str) -> tuple[str, ...]:
    """Return what a setting names: nothing, one or several."""
    given = values.get(setting) or ()
    return (given,) if isinstance(given, str) else tuple(given)
