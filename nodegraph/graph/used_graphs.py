"""The graph files that a graph uses: each is checked once, by itself.

Stand-ins of the declared types take the place of its ports. Errors inside a file are thus
reported once and under the names that it has there, and a graph that uses it has only to fit its
ports, settings and outputs.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path

from nodegraph.errors import Problems, quoted
from nodegraph.graph.assembly import Assembler
from nodegraph.graph.flatten import FlatGraph, flatten
from nodegraph.graph.model import Choices
from nodegraph.graph.pass_through import graph_as_node
from nodegraph.graph.subgraph import Subgraph, invalid_subgraph, subgraph_of
from nodegraph.graphfile.spec import GraphSpec
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registry


class UsedGraphs:
    """The graph files that a graph uses, each of which is checked once.

    Parameters
    ----------
    specs
    registry
    problems
        Receives the errors in these files.
    """

    def __init__(
        self, specs: Mapping[Path, GraphSpec], registry: Registry, problems: Problems
    ) -> None:
        self._specs = specs
        self._registry = registry
        self._problems = problems
        self._checked: dict[Path, Subgraph] = {}

    def nodes(self, spec: GraphSpec) -> dict[str, Node]:
        """Return the graph files that a graph uses as nodes, by what ``use`` names."""
        used = {name: self._subgraph(path) for name, path in spec.uses.items()}
        return {
            name: graph_as_node(
                name, graph.spec.title, tuple(graph.inputs.values()), tuple(graph.outputs.values())
            )
            for name, graph in used.items()
        }

    def flat(self, spec: GraphSpec, problems: Problems) -> FlatGraph:
        """Return a graph in which the graphs that it uses are inlined."""
        return flatten(spec, dict(self._ports(spec, problems)), self._subgraph, problems)

    def _subgraph(self, path: Path) -> Subgraph:
        if path not in self._checked:
            self._checked[path] = self._check(self._specs[path])
        return self._checked[path]

    def _check(self, spec: GraphSpec) -> Subgraph:
        problems = Problems(spec.problems)
        flat = self.flat(spec, problems)
        graph = Assembler(flat, self._registry, Choices(), problems).graph()
        if graph is None:
            subgraph = invalid_subgraph(flat.spec, flat.ports)
        else:
            subgraph = subgraph_of(graph, flat.ports, flat.stand_ins, problems)
        self._problems.extend(problems.all())
        return subgraph

    def _ports(self, spec: GraphSpec, problems: Problems) -> Iterator[tuple[str, Port]]:
        """Yield the inputs that are ports: their value is the name of a port's type."""
        for name, part in spec.inputs.items():
            if not isinstance(part.value, str) or not part.value.isidentifier():
                continue
            types = self._types.get(part.value, {})
            if len(types) > 1:
                names = " and ".join(sorted(f"{kind.__module__}.{part.value}" for kind in types))
                problems.add(
                    part.place, f"{quoted(part.value)} is the name of several types: {names}"
                )
            if types:
                yield name, Port(name, next(iter(types)))

    @cached_property
    def _types(self) -> Mapping[str, Mapping[type, None]]:
        """The types of all ports of installed nodes, by name."""
        types: dict[str, dict[type, None]] = defaultdict(dict)
        for registered in self._registry:
            for port in (*registered.node.inputs, *registered.node.outputs):
                types[port.type.__name__][port.type] = None
        return types
