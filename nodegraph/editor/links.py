"""The links of a graph file that are there, and that could be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import networkx as nx

from nodegraph.edit.document import Document
from nodegraph.edit.uses import Role, mapping, nodes_of, uses
from nodegraph.errors import GraphError, Problems, nearest, quoted
from nodegraph.graph.used_graphs import UsedGraphs
from nodegraph.graphfile import read_graph_text
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port, mismatch
from nodegraph.plugin.registry import Registry

Data = dict[str, Any]


class Links:
    """What the nodes of a text give and take, whether or not it is a valid graph.

    Parameters
    ----------
    text
    path
        The graph file.
    registry

    Attributes
    ----------
    document : Document
    nodes : mapping of name to its entry
    defaults : mapping of text to mapping
        The inputs, with their values, that a node can set of a graph file, by what ``use`` names.

    Raises
    ------
    GraphError
        If the text is not YAML.
    """

    def __init__(self, text: str, path: Path, registry: Registry) -> None:
        self.document = Document(text, path.name)
        self.nodes = mapping(mapping(self.document.data).get("nodes"))
        self._registry = registry
        self._graphs: Mapping[str, Node] = {}
        self.defaults: Mapping[str, Mapping[str, object]] = {}
        try:
            spec = read_graph_text(text, path.name, path.parent)
        except GraphError:
            return
        self._graphs = UsedGraphs(spec.graphs, registry, Problems()).nodes(spec)
        self.defaults = {
            use: {
                name: part.value
                for name, part in spec.graphs[spec.uses[use]].inputs.items()
                if node.port(name) is None
            }
            for use, node in self._graphs.items()
        }

    def of(self, entry: object) -> list[Node]:
        """Return the nodes that an entry, or one of its alternatives, uses."""
        return list(nodes_of(entry, self._registry, self._graphs))

    def entry(self, name: str) -> object:
        """Return the entry of a node.

        Raises
        ------
        GraphError
            If there is none.
        """
        if name not in self.nodes:
            raise self.document.error(0, f"no node {quoted(name)}", nearest(name, self.nodes))
        return self.nodes[name]

    def ports(self, name: str) -> dict[str, tuple[Port, Node]]:
        """Return the ports of a node's methods, each with the first method that has it."""
        ports: dict[str, tuple[Port, Node]] = {}
        for node in self.of(self.entry(name)):
            for port in node.inputs:
                ports.setdefault(port.name, (port, node))
        return ports

    def sources(self, name: str, port: str) -> Iterator[Data]:
        """Yield the outputs of all other nodes, each with why it does not fit, if it does not."""
        target = _as_fed(*self.ports(name)[port])
        after = self._linked(name, forward=True)
        for other in self.nodes:
            if other == name:
                continue
            outputs = self._outputs(other)
            reason = f"{other} reads {name}" if other in after else ""
            if not outputs:
                yield {"source": other, "type": "", "reason": reason}
            for wire, output in outputs.items():
                yield {
                    "source": wire,
                    "type": output.kind,
                    "reason": reason or mismatch(output, target) or "",
                }

    def targets(self, box: str, output: str) -> Data:
        """Return what an output of a box in the picture is, and which ports it fits.

        Returns
        -------
        data
            The `source` as a link names it, and for each other node and port why it does not fit,
            if it does not.

        Raises
        ------
        GraphError
            If no link can begin there.
        """
        name, source, port = self._output(box, output)
        before = self._linked(name, forward=False)
        found: dict[str, dict[str, str]] = {}
        for other in self.nodes:
            reason = f"{name} reads {other}" if other in before else ""
            reason = "a node cannot feed itself" if other == name else reason
            found[other] = {
                each: reason or mismatch(port, _as_fed(target, node)) or ""
                for each, (target, node) in self.ports(other).items()
            }
        return {"source": source, "ports": found}

    def fitting(self, use: str, source: str) -> object:
        """Return what feeds the first port of a method that a node fits; None if none does.

        Parameters
        ----------
        use
        source
            A node, any of whose outputs may feed it, or one output.
        """
        name, _, output = source.partition(".")
        nodes = self.of(use)
        outputs = self._outputs(name)
        for place, target in enumerate(nodes[0].inputs if nodes else ()):
            for wire, each in outputs.items():
                if output in ("", each.name) and not mismatch(each, _as_fed(target, nodes[0])):
                    return wire if place == 0 else {target.name: wire}
        return None

    def wiring(self, use: str, source: str) -> object:
        """Return what feeds a method that a node fits; None if none does.

        That is the node at the first port that it fits, and at other ports that need one the only
        output of the graph that fits: the truth, of several, where the port takes the truth.

        Parameters
        ----------
        use, source
            As in `fitting`.
        """
        first = self.fitting(use, source)
        if first is None:
            return None
        node = self.of(use)[0]
        wires = {**mapping(first)} or {node.inputs[0].name: first}
        for target in node.inputs:
            fits = [
                wire
                for name in self.nodes
                for wire, output in self._outputs(name).items()
                if output.truth == target.truth and not mismatch(output, target)
            ]
            if target.name not in wires and not target.optional and len(fits) == 1:
                wires[target.name] = fits[0]
        return first if len(wires) == 1 else wires

    def _output(self, box: str, output: str) -> tuple[str, str, Port]:
        """Return the node of an output of a box, the output as a link names it, and its port."""
        name, _, inside = box.partition(".")
        outputs = self._outputs(name)
        for wire, port in outputs.items():
            if port.name == (inside or output):
                return name, wire, port
        message = f"{quoted(box)} is part of a graph of its own"
        names = ", ".join(port.name for port in outputs.values())
        hint = f"outside it are {names}" if names else ""
        raise self.document.error(0, message, hint)

    def _outputs(self, name: str) -> dict[str, Port]:
        """Return the outputs of a node, as links name them."""
        used = self.of(self.nodes.get(name))
        outputs = used[0].outputs if used else ()
        return {f"{name}.{port.name}" if len(outputs) > 1 else name: port for port in outputs}

    def _linked(self, name: str, *, forward: bool) -> set[str]:
        """Return the nodes that read a node, directly or not; or those that it reads."""
        links = nx.DiGraph(
            (use.name, str(use.path[1]))
            for use in uses(self.document.data, self._registry)
            if use.role is Role.SOURCE and use.path[0] == "nodes"
        )
        if name not in links:
            return set()
        return nx.descendants(links, name) if forward else nx.ancestors(links, name)


def _as_fed(port: Port, node: Node) -> Port:
    """Return a port as what feeds it sees it: a node that damages the truth may read it."""
    return replace(port, truth=True) if node.damages and not port.truth else port
