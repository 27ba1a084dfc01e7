"""Graphs used as nodes: each is checked by itself, once, and put in the place of the node.

A graph file is checked as it stands, with something of the declared type behind each of its ports.
What is wrong inside is so told once, with the names that it has there; whoever uses the file only
has to fit its ports, settings and outputs.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path

from nodegraph.errors import Problems
from nodegraph.graph.builder import Builder
from nodegraph.graph.choices import Choices
from nodegraph.graph.flat import Flat
from nodegraph.graph.subgraph import Subgraph, broken, subgraph_of
from nodegraph.graph.unfolding import Unfolding
from nodegraph.ports import Port
from nodegraph.registry import Registry
from nodegraph.spec.parts import GraphSpec


class Subgraphs:
    """The graph files that a graph uses.

    Parameters
    ----------
    specs
    registry
    problems
        Where mistakes in these files are noted.
    """

    def __init__(
        self, specs: Mapping[Path, GraphSpec], registry: Registry, problems: Problems
    ) -> None:
        self._specs = specs
        self._registry = registry
        self._problems = problems
        self._checked: dict[Path, Subgraph] = {}

    def flat(self, spec: GraphSpec, problems: Problems) -> Flat:
        """Return a graph with the nodes of the graphs that it uses in their place."""
        ports = dict(self._ports(spec, problems))
        uses_graphs = any(one.is_graph for node in spec.nodes.values() for one in node.methods)
        if not ports and not uses_graphs:
            return Flat(spec, {}, {}, (), (), is_whole=True)
        return Unfolding(spec, ports, self.checked, problems).flat()

    def checked(self, path: Path) -> Subgraph:
        """Return the graph of a file, which is checked when it is asked for first."""
        if path not in self._checked:
            self._checked[path] = self._check(self._specs[path])
        return self._checked[path]

    def _check(self, spec: GraphSpec) -> Subgraph:
        problems = Problems(spec.problems)
        flat = self.flat(spec, problems)
        graph = Builder(flat, self._registry, Choices(), problems).build()
        made = broken(flat)
        if flat.is_whole and not problems:
            made = subgraph_of(flat, graph, problems)
        for one in problems.all():
            self._problems.add(one.place, one.message, one.instead)
        return made

    def _ports(self, spec: GraphSpec, problems: Problems) -> Iterator[tuple[str, Port]]:
        """Yield the inputs whose value is the name of a port's type."""
        for name, one in spec.inputs.items():
            if not isinstance(one.value, str) or not one.value.isidentifier():
                continue
            types = self._types.get(one.value, {})
            if len(types) > 1:
                where = " and ".join(sorted(f"{kind.__module__}.{one.value}" for kind in types))
                problems.add(one.place, f"{one.value!r} is the name of several types: {where}")
            if types:
                yield name, Port(name, next(iter(types)))

    @cached_property
    def _types(self) -> Mapping[str, dict[type, None]]:
        """The types of all ports of installed nodes, by name."""
        found: dict[str, dict[type, None]] = defaultdict(dict)
        for registered in self._registry:
            for port in (*registered.node.inputs, *registered.node.outputs):
                found[port.type.__name__][port.type] = None
        return found
