"""What a page shows of one node: its methods, what feeds it, and its settings as a form."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

from nodegraph.edit.document import Document, flow
from nodegraph.edit.uses import mapping, shown_at
from nodegraph.editor.completion import ABOUT_PASS, is_closed, words_of
from nodegraph.editor.links import Data, Links
from nodegraph.graphfile.keys import PASS
from nodegraph.graphfile.nodes import label_of
from nodegraph.graphfile.schema import about_node, names_of
from nodegraph.graphfile.settings_schema import settings_schema
from nodegraph.node.decorator import Node
from nodegraph.node.description import meanings, plain_summary_of
from nodegraph.plugin.registry import Registry


def axes_of(text: str, file: str) -> list[Data]:
    """Return the axes of a graph file, each with its labels as they can be written.

    Raises
    ------
    GraphError
        If the text is not YAML.
    """
    axes = mapping(mapping(Document(text, file).data).get("axes"))
    return [{"name": str(name), "labels": flow(labels)} for name, labels in axes.items()]


def installed(registry: Registry, links: Links | None = None, source: str = "") -> list[Data]:
    """Return the nodes that can be added, each with what is said of it.

    Of those, with a source, only the ones that it can feed.
    """
    return [
        {"use": name, "about": about_node(registered)}
        for registered, (name, *_) in names_of(registry).items()
        if not registered.node.deprecated and (links is None or links.fitting(name, source))
    ]


def panel_of(text: str, name: str, registry: Registry, path: Path) -> Data:
    """Return what is shown of a node.

    Parameters
    ----------
    text
    name
    registry
    path
        The graph file.

    Raises
    ------
    GraphError
        If the text is not YAML, or has no such node.
    """
    return _Panel(Links(text, path, registry), name, registry).data()


class _Panel:
    def __init__(self, links: Links, name: str, registry: Registry) -> None:
        self._links = links
        self._name = name
        self._registry = registry
        self._entry = mapping(links.entry(name))
        self._used = links.of(links.entry(name))
        self._data = links.document.data
        listed = self._entry.get("alternatives")
        names = listed if isinstance(listed, list) else []
        self._methods = {label_of(str(use)): {"use": use} for use in names} or mapping(listed)

    def data(self) -> Data:
        return {
            "name": self._name,
            "is_shown": bool(shown_at(self._data, self._name)),
            "sections": list(self._sections()),
            "ports": list(self._ports()),
            "rivals": self._rivals(),
            "alternatives": [str(label) for label in self._methods],
        }

    def _sections(self) -> Iterator[Data]:
        """Yield the methods, each with a form, and that of the settings which they share."""
        path = ["nodes", self._name]
        for label, method in self._methods.items():
            used = self._links.of(method if mapping(method).get("use") else label)
            yield self._section(str(label), [*path, "alternatives", label], used[:1], method)
        if self._entry.get("alternatives") is None:
            yield self._section("", path, self._used[:1], self._entry)
        elif self._used:
            yield self._section("all alternatives", path, self._used, self._entry)

    def _section(self, title: str, path: list[str], used: list[Node], entry: object) -> Data:
        """Return the form of the settings that all of these nodes have; the entry sets some."""
        schemas = [settings_schema(node) for node in used]
        common = {
            name: schema
            for name, schema in (schemas[0] if schemas else {}).items()
            if all(name in other for other in schemas)
        }
        written = mapping(mapping(entry).get("with"))
        shared = mapping(self._entry.get("with")) if len(path) > 2 else {}
        known = [*mapping(self._data.get("axes")), *mapping(self._data.get("inputs"))]
        forms = {
            name: {
                "about": _shared(str(each[name]["description"]) for each in schemas),
                "words": words_of(schema),
                "is_closed": is_closed(schema),
                "is_required": any(node.settings[name].required for node in used),
            }
            for name, schema in common.items()
        } | {
            name: {
                "about": f"Default: {flow(value)}.",
                "words": [],
                "is_closed": False,
                "is_required": False,
            }
            for node in used[:1]
            for name, value in self._links.defaults.get(node.name, {}).items()
        }
        settings = [
            {
                "name": name,
                "path": [*path, "with", name],
                "value": flow(written[name]) if name in written else "",
                "shared": flow(shared[name]) if name in shared else "",
                "variables": [f"${each}" for each in known],
                **form,
            }
            for name, form in forms.items()
        ]
        about = [used[0].name, plain_summary_of(used[0])] if len(used) == 1 else []
        if mapping(entry).get("use") == PASS:
            about = [PASS, ABOUT_PASS]
        return {
            "title": title,
            "alternative": path[-1] if len(path) > 2 else None,
            "about": about,
            "settings": settings,
            "is_known": bool(about or used),
        }

    def _ports(self) -> Iterator[Data]:
        """Yield the ports, each with what feeds it, and what could."""
        wiring = self._entry.get("in")
        for place, (name, (port, node)) in enumerate(self._links.ports(self._name).items()):
            is_named = isinstance(wiring, dict) and "from" not in wiring
            feed = mapping(wiring).get(name) if is_named else wiring if place == 0 else None
            yield {
                "name": name,
                "type": port.kind,
                "about": meanings(node).get(name, ""),
                "is_optional": port.optional,
                "feed": "" if feed is None else feed if isinstance(feed, str) else flow(feed),
                "sources": list(self._links.sources(self._name, name)),
            }

    def _rivals(self) -> list[Data]:
        """Return the methods of the family, each with why it cannot stand beside these."""
        family = self._used[0].family if self._used else ""
        used = {node.name for node in self._used}
        return [
            {
                "use": name,
                "about": plain_summary_of(each.node),
                "is_used": each.node.name in used,
                "reason": self._misfit(each.node),
            }
            for each, (name, *_) in names_of(self._registry).items()
            if each.node.family == family and not each.node.deprecated
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


def _shared(texts: Iterable[str]) -> str:
    """Return what most methods say of a setting."""
    ((text, _),) = Counter(texts).most_common(1)
    return text
