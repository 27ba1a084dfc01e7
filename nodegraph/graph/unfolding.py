"""Nodes that use graphs -> the nodes of these graphs, and what hands on what they give.

A node that uses a graph becomes one that hands on the graph's first output; each further output
has a node of its own, ``clean.detail``, so that none takes part in axes that only others have.
Where graphs stand among alternatives, the node hands on all outputs, as its other methods do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from nodegraph.errors import Place, Problems
from nodegraph.graph.flat import Feed, Flat
from nodegraph.graph.hands_on import HandsOn, port_node
from nodegraph.graph.placed import Placed
from nodegraph.graph.subgraph import Subgraph
from nodegraph.graph.uses import Use, fits
from nodegraph.graph.wiring import labelled
from nodegraph.ports import Port
from nodegraph.registry import Registered
from nodegraph.spec.parts import (
    Gathering,
    GraphSpec,
    MethodSpec,
    NodeSpec,
    Reference,
    Wiring,
    Written,
)


class Unfolding:
    """Puts the graphs that the nodes of one graph use in the place of these nodes.

    Parameters
    ----------
    spec
    ports
        Its inputs that are ports.
    find
        Returns the checked graph of a file.
    problems
        Where mistakes in the use of graphs are noted.
    """

    def __init__(
        self,
        spec: GraphSpec,
        ports: Mapping[str, Port],
        find: Callable[[Path], Subgraph],
        problems: Problems,
    ) -> None:
        self._spec = spec
        self._ports = ports
        self._problems = problems
        self._nodes: dict[str, NodeSpec] = {}
        self._axes = dict(spec.axes)
        self._skip = list(spec.skip)
        self._known: list[Reference] = []
        self._requires = dict.fromkeys(spec.requires)
        self._graphs: dict[str, dict[str, Registered]] = {}
        self._feeds: list[Feed] = []
        self._given: list[Written] = []
        self._uses = dict(self._found(find))
        self._fitting = {at for at, use in self._uses.items() if fits(use, problems)}

    def flat(self) -> Flat:
        """Return the graph with everything in its place."""
        for name, port in self._ports.items():
            self._stand(f"${name}", port_node(port), self._spec.inputs[name].place, {})
        for node in self._spec.nodes.values():
            methods = tuple(self._method(node, one) for one in node.methods)
            self._nodes[node.name] = replace(node, methods=methods, wiring=self._led(node.wiring))
        outputs = self._spec.outputs.items()
        spec = replace(
            self._spec,
            nodes=self._nodes,
            axes=self._axes,
            skip=tuple(self._skip),
            known=(*self._all_led(self._spec.known), *self._known),
            requires=tuple(self._requires),
            outputs={name: self._one_led(one) for name, one in outputs},
            report=tuple(self._all_led(self._spec.report)),
            written=self._spec,
        )
        is_whole = len(self._fitting) == sum(1 for _ in self._graph_methods())
        feeds, given = tuple(self._feeds), tuple(self._given)
        return Flat(spec, self._ports, self._graphs, feeds, given, is_whole)

    def _graph_methods(self) -> Iterator[tuple[NodeSpec, MethodSpec]]:
        for node in self._spec.nodes.values():
            yield from ((node, one) for one in node.methods if one.is_graph)

    def _found(self, find: Callable[[Path], Subgraph]) -> Iterator[tuple[tuple[str, str], Use]]:
        for node, method in self._graph_methods():
            path = self._spec.uses.get(method.use)
            if path is not None:
                yield (node.name, method.label), Use(node, method, find(path))

    def _method(self, node: NodeSpec, method: MethodSpec) -> MethodSpec:
        """Return a method with its graph, if it uses one, put in place."""
        if not method.is_graph:
            return replace(method, wiring=self._led(method.wiring))
        use = self._uses.get((node.name, method.label))
        if use is not None:
            self._given.extend(use.settings.values())
            self._feed(use)
        if use is None or (node.name, method.label) not in self._fitting:
            return replace(method, use="", wiring=self._led(method.wiring))
        placed = Placed(use.prefix, use.graph.spec, self._led(use.wiring), use.settings)
        self._put(placed, use)
        outputs = placed.fed(use.graph.spec.outputs)
        handed = outputs if node.has_alternatives else self._parted(use, outputs)
        made = Registered(use.stand_in(*handed), "nodegraph")
        self._graphs.setdefault(node.name, {})[method.label] = made
        return replace(method, wiring=handed, settings={})

    def _parted(self, use: Use, outputs: Wiring) -> Wiring:
        """Give all outputs but the first nodes of their own, where they are none; return that."""
        first, *others = outputs
        for name in others:
            if name not in use.graph.spec.nodes:
                stand_in, wiring = use.stand_in(name), {name: outputs[name]}
                self._stand(use.prefix + name, stand_in, use.node.place, wiring)
        return {first: outputs[first]}

    def _stand(self, name: str, node: HandsOn, place: Place, wiring: Wiring) -> None:
        method = MethodSpec("", node.name, place, wiring)
        self._nodes[name] = NodeSpec(name, place, (method,), False, {}, {}, None)
        self._graphs[name] = {"": Registered(node, "nodegraph")}

    def _put(self, placed: Placed, use: Use) -> None:
        for inner in placed.nodes():
            if inner.name in self._nodes:
                message = f"two nodes would be called {inner.name!r}"
                instead = f"rename the label {use.method.label!r}"
                self._problems.add(use.method.place, message, instead)
            self._nodes[inner.name] = inner
        self._axes |= {axis.name: axis for axis in placed.axes()}
        self._skip.extend(placed.skip())
        self._known.extend(placed.known())
        self._requires |= dict.fromkeys(use.graph.spec.requires)
        for name, graphs in use.graph.graphs.items():
            self._graphs[placed.prefix + name] = dict(graphs)

    def _feed(self, use: Use) -> None:
        for name, fed in self._led(use.wiring).items():
            port = use.graph.asks.get(name)
            self._feeds += [Feed(use.where, port, source) for _, source in labelled(fed)]

    def _led(self, wiring: Wiring) -> Wiring:
        """Return wires that lead to the nodes that hand on outputs of graphs."""
        if not self._fitting:
            return wiring
        return {
            port: Gathering({k: self._one_led(one) for k, one in fed.sources.items()}, fed.place)
            if isinstance(fed, Gathering)
            else self._one_led(fed)
            for port, fed in wiring.items()
        }

    def _one_led(self, source: Reference) -> Reference:
        if (source.node, "") not in self._fitting:
            return source
        use = self._uses[source.node, ""]
        _, *others = use.graph.outputs
        if source.port in others:
            return replace(source, node=use.prefix + source.port, port="")
        return source

    def _all_led(self, references: Iterable[Reference]) -> Iterator[Reference]:
        """Yield references to nodes; one to a node that uses a graph means all its outputs."""
        for one in references:
            ports = [one.port]
            if not one.port and (one.node, "") in self._fitting:
                ports = ["", *list(self._uses[one.node, ""].graph.outputs)[1:]]
            yield from (self._one_led(replace(one, port=port)) for port in ports)
