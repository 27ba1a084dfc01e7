"""A graph where a node uses it: its nodes with the names, feeds and settings they get there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from nodegraph.spec.parts import (
    AxisSpec,
    Gathering,
    GraphSpec,
    MethodSpec,
    NodeSpec,
    Reference,
    SkipSpec,
    Variable,
    Wiring,
    Written,
)

MOST_VALUES = 100_000
MOST_DEPTH = 100


@dataclass(frozen=True)
class Placed:
    """A graph where a node uses it.

    Attributes
    ----------
    prefix : str
        Comes before the names of its nodes and axes: ``clean.``.
    spec : GraphSpec
        The graph, flat; only what is to be put in place.
    wiring : mapping of port to Reference or Gathering
        What feeds its ports.
    settings : mapping of input to Written
        What its other inputs are given.
    """

    prefix: str
    spec: GraphSpec
    wiring: Mapping[str, Reference | Gathering]
    settings: Mapping[str, Written]

    def nodes(self) -> Iterator[NodeSpec]:
        """Yield its nodes."""
        for node in self.spec.nodes.values():
            yield replace(
                node,
                name=self.prefix + node.name,
                methods=tuple(map(self._method, node.methods)),
                wiring=self.fed(node.wiring),
                settings=self._given(node.settings),
                over=node.over and tuple((self.prefix + axis, at) for axis, at in node.over),
                prefix=self.prefix + node.prefix,
            )

    def axes(self) -> Iterator[AxisSpec]:
        """Yield its axes."""
        for axis in self.spec.axes.values():
            folder = axis.folder or self.spec.folder
            yield replace(axis, name=self.prefix + axis.name, folder=folder)

    def skip(self) -> Iterator[SkipSpec]:
        """Yield the combinations that it leaves out."""
        for item in self.spec.skip:
            yield replace(item, labels={self.prefix + k: one for k, one in item.labels.items()})

    def known(self) -> Iterator[Reference]:
        """Yield what its methods may know."""
        return (self._renamed(one) for one in self.spec.known)

    def fed(self, wiring: Wiring) -> Wiring:
        """Return wires between its nodes, with those that come in from outside."""
        return {port: self._source(fed) for port, fed in wiring.items()}

    def _method(self, method: MethodSpec) -> MethodSpec:
        if not method.wiring and not method.settings:
            return method
        wiring, settings = self.fed(method.wiring), self._given(method.settings)
        return replace(method, wiring=wiring, settings=settings)

    def _source(self, fed: Reference | Gathering) -> Reference | Gathering:
        if isinstance(fed, Gathering):
            sources = {label: self._one(source) for label, source in fed.sources.items()}
            return Gathering(sources, fed.place)
        return self._from_outside(fed) if fed.node.startswith("$") else self._renamed(fed)

    def _one(self, source: Reference) -> Reference:
        found = self._source(source)
        assert isinstance(found, Reference), "a port that feeds one of several takes one value"
        return found

    def _from_outside(self, source: Reference) -> Reference | Gathering:
        found = self.wiring[source.node[1:]]
        if isinstance(found, Reference):
            return replace(found, passed=True)
        passed = {label: replace(one, passed=True) for label, one in found.sources.items()}
        return Gathering(passed, found.place)

    def _renamed(self, source: Reference) -> Reference:
        at = {self.prefix + axis: label for axis, label in source.at.items()}
        return replace(source, node=self.prefix + source.node, at=at)

    def _given(self, settings: Mapping[str, Written]) -> dict[str, Written]:
        return {name: self._written(one) for name, one in settings.items()}

    def _written(self, written: Written) -> Written:
        folder = written.folder or self.spec.folder
        if isinstance(written.value, Variable):
            return self._stands_for(written.value, replace(written, folder=folder))
        return replace(written, value=self._replaced(written.value), folder=folder)

    def _replaced(self, value: Any) -> Any:
        if isinstance(value, Variable):
            return self._stands_for(value, Written(None, value.place)).value
        if isinstance(value, dict):
            return {key: self._replaced(one) for key, one in value.items()}
        if isinstance(value, list):
            return [self._replaced(one) for one in value]
        return value

    def _stands_for(self, variable: Variable, written: Written) -> Written:
        """Return what a variable of the graph stands for here."""
        name = variable.name
        if name not in self.spec.inputs:
            return replace(written, value=replace(variable, name=self.prefix + name))
        given = self.settings.get(name) or replace(written, value=self.spec.inputs[name].value)
        return replace(given, value=field_of(given.value, variable.field))


def field_of(value: Any, name: str) -> Any:
    """Return one field of a value, which may stand for another.

    Raises
    ------
    KeyError
        If it has no such field.
    """
    if not name:
        return value
    if isinstance(value, Variable) and not value.field:
        return replace(value, field=name)
    if isinstance(value, dict):
        return value[name]
    raise KeyError(name)


def written_in(nodes: Iterable[NodeSpec]) -> Iterator[Written]:
    """Yield every setting of nodes and of their methods."""
    for node in nodes:
        yield from node.settings.values()
        for method in node.methods:
            yield from method.settings.values()


def unfolds_too_far(spec: GraphSpec, settings: Mapping[str, Written]) -> bool:
    """Whether a graph's settings become endless with these in them: what holds one twice doubles.

    Each graph of a chain of graphs may double what it is given before it hands it on.
    """
    extents = {name: _extent(one.value) for name, one in settings.items()}
    total = 0
    for written in written_in(spec.nodes.values()):
        size, depth = _extent(written.value)
        put_in = [extents[one.name] for one in written.variables() if one.name in extents]
        depth += max((deeper for _, deeper in put_in), default=0)
        total += size + sum(more for more, _ in put_in)
        if total > MOST_VALUES or depth > MOST_DEPTH:
            return True
    return False


def _extent(value: Any) -> tuple[int, int]:
    """Return how many values there are in one, and how deep they lie."""
    size = depth = 0
    pending = [(value, 0)]
    while pending:
        one, level = pending.pop()
        size, depth = size + 1, max(depth, level)
        if isinstance(one, (dict, list)):
            items = one.values() if isinstance(one, dict) else one
            pending.extend((item, level + 1) for item in items)
    return size, depth
