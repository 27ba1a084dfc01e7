"""What a page shows of one node: its methods, what feeds it, and its settings as a form."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from nodegraph.edit.document import Document, flow, value_at
from nodegraph.edit.uses import Kind, mapping, nodes_of, uses
from nodegraph.editor.completion import is_closed, words_of
from nodegraph.errors import nearest, quoted
from nodegraph.graphfile.nodes import label_of
from nodegraph.graphfile.schema import about_node, names_of
from nodegraph.graphfile.settings_schema import settings_schema
from nodegraph.node.decorator import Node
from nodegraph.node.description import meanings
from nodegraph.node.ports import Port, mismatch
from nodegraph.plugin.registry import Registry

Data = dict[str, Any]


def axes_of(text: str, file: str) -> list[Data]:
    """Return the axes of a graph file, each with its labels as they can be written.

    Raises
    ------
    GraphError
        If the text is not YAML.
    """
    axes = mapping(mapping(Document(text, file).data).get("axes"))
    return [{"name": str(name), "labels": flow(labels)} for name, labels in axes.items()]


def installed(registry: Registry) -> list[Data]:
    """Return the nodes that can be added, each with what is said of it."""
    return [
        {"use": name, "about": about_node(registered)}
        for registered, (name, *_) in names_of(registry).items()
        if not registered.node.deprecated
    ]


def panel_of(text: str, name: str, registry: Registry, file: str) -> Data:
    """Return what is shown of a node.

    Parameters
    ----------
    text
    name
    registry
    file
        The name of the file in messages.

    Raises
    ------
    GraphError
        If the text is not YAML, or has no such node.
    """
    document = Document(text, file)
    nodes = mapping(mapping(document.data).get("nodes"))
    if name not in nodes:
        raise document.error(0, f"no node {quoted(name)}", nearest(name, nodes))
    return _Panel(document, nodes, name, registry).data()


class _Panel:
    def __init__(
        self, document: Document, nodes: Mapping[Any, Any], name: str, registry: Registry
    ) -> None:
        self._nodes = nodes
        self._name = name
        self._registry = registry
        self._entry = mapping(nodes[name])
        self._used = list(nodes_of(nodes[name], registry))
        self._data = document.data

    def data(self) -> Data:
        alternatives = self._entry.get("alternatives")
        return {
            "name": self._name,
            "sections": list(self._sections()),
            "ports": list(self._ports()),
            "rivals": self._rivals(),
            "alternatives": self._labels(alternatives),
        }

    def _sections(self) -> Iterator[Data]:
        """Yield the methods, each with a form, and that of the settings which they share."""
        path = ["nodes", self._name]
        alternatives = self._entry.get("alternatives")
        for label, method in mapping(alternatives).items():
            used = list(nodes_of(method if mapping(method).get("use") else label, self._registry))
            yield self._section(str(label), [*path, "alternatives", label], used[:1])
        if alternatives is None:
            yield self._section("", path, self._used[:1])
        elif self._used:
            yield self._section("all alternatives", path, self._used)

    def _section(self, title: str, path: list[str], used: list[Node]) -> Data:
        """Return the form of the settings that all of these nodes have."""
        schemas = [settings_schema(node) for node in used]
        common = {
            name: schema
            for name, schema in (schemas[0] if schemas else {}).items()
            if all(name in other for other in schemas)
        }
        written = mapping(value_at(self._data, (*path, "with")))
        known = [*mapping(self._data.get("axes")), *mapping(self._data.get("inputs"))]
        settings = [
            {
                "name": name,
                "path": [*path, "with", name],
                "about": str(schema["description"]),
                "value": flow(written[name]) if name in written else "",
                "words": words_of(schema),
                "is_closed": is_closed(schema),
                "variables": [f"${each}" for each in known],
            }
            for name, schema in common.items()
        ]
        about = [used[0].name, used[0].summary] if len(used) == 1 else []
        return {
            "title": title,
            "about": about,
            "settings": settings,
            "is_known": bool(used),
        }

    def _ports(self) -> Iterator[Data]:
        """Yield the ports, each with what feeds it, and what could."""
        wiring = self._entry.get("in")
        ports: dict[str, tuple[Port, Node]] = {}
        for node in self._used:
            for port in node.inputs:
                ports.setdefault(port.name, (port, node))
        after = self._after()
        for place, (name, (port, node)) in enumerate(ports.items()):
            is_named = isinstance(wiring, dict) and "from" not in wiring
            feed = mapping(wiring).get(name) if is_named else wiring if place == 0 else None
            target = replace(port, truth=True) if node.damages and not port.truth else port
            yield {
                "name": name,
                "type": str(port).partition(": ")[2],
                "about": meanings(node).get(name, ""),
                "is_optional": port.optional,
                "feed": "" if feed is None else feed if isinstance(feed, str) else flow(feed),
                "sources": list(self._sources(target, after)),
            }

    def _sources(self, port: Port, after: set[str]) -> Iterator[Data]:
        """Yield the outputs of all other nodes, each with why it does not fit, if it does not."""
        for name, entry in self._nodes.items():
            if name == self._name:
                continue
            node = next(nodes_of(entry, self._registry), None)
            outputs = node.outputs if node else ()
            reason = f"{name} reads {self._name}" if name in after else ""
            if not outputs:
                yield {"source": name, "type": "", "reason": reason}
            for output in outputs:
                yield {
                    "source": f"{name}.{output.name}" if len(outputs) > 1 else name,
                    "type": str(output).partition(": ")[2],
                    "reason": reason or mismatch(output, port) or "",
                }

    def _after(self) -> set[str]:
        """Return the nodes that read this, directly or not."""
        readers: dict[str, set[str]] = {}
        for use in uses(self._data, self._registry):
            if use.kind is Kind.SOURCE and use.path[0] == "nodes":
                readers.setdefault(use.name, set()).add(str(use.path[1]))
        pending, after = [self._name], set[str]()
        while pending:
            new = readers.get(pending.pop(), set()) - after
            after |= new
            pending += new
        return after

    def _rivals(self) -> list[Data]:
        """Return the other methods of the family, each with why it cannot stand beside these."""
        family = self._used[0].family if self._used else ""
        used = {node.name for node in self._used}
        return [
            {"use": name, "about": each.node.summary, "reason": self._misfit(each.node)}
            for each, (name, *_) in names_of(self._registry).items()
            if each.node.family == family
            and each.node.name not in used
            and not each.node.deprecated
        ]

    def _misfit(self, node: Node) -> str:
        """Return what of a method's ports does not fit what feeds this node."""
        wiring = self._entry.get("in")
        first = [port.name for port in node.inputs[:1]]
        if isinstance(wiring, dict) and "from" not in wiring:
            fed = [str(port) for port in wiring]
        else:
            fed = first or ["input"] if wiring is not None else []
        for port in fed:
            if node.port(port) is None:
                return f"it has no port {port}"
        for needed in node.inputs:
            if not needed.optional and needed.name not in fed:
                return f"nothing feeds its port {needed.name}"
        return ""

    def _labels(self, alternatives: object) -> list[str]:
        """Return the labels of the alternatives that can be removed."""
        if isinstance(alternatives, list):
            return [label_of(str(use)) for use in alternatives]
        return [str(label) for label in mapping(alternatives)]
