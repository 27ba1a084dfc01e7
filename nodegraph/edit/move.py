"""Move nodes of a graph file into a graph file of their own, which takes their place."""

from __future__ import annotations

import json
import pathlib
import re
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import networkx as nx

from nodegraph.edit.actions import check_new_name
from nodegraph.edit.document import Change, Document, Path, value_at
from nodegraph.edit.uses import Role, Use, free_name, mapping, nodes_of, pattern_of, uses
from nodegraph.errors import quoted
from nodegraph.graphfile.keys import FORMAT
from nodegraph.graphfile.reader import read_graph_text
from nodegraph.graphfile.spec import is_graph_file
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registry


def move_to_graph(
    text: str,
    nodes: Collection[str],
    name: str,
    path: str,
    *,
    registry: Registry | None = None,
    file: str = "graph",
) -> tuple[str, str]:
    """Move nodes into a graph file of their own, and use that in their place.

    What feeds them becomes a port of the new graph, what their settings take an input with its
    present value, and what others read of them an output. An axis of theirs has the new node's name
    before its own: ``clean.fill``. Relative paths in their settings then start in the new file's
    folder.

    Parameters
    ----------
    text
    nodes
    name
        The name of the node that takes their place.
    path
        The new graph file, from the folder of this: ``parts/clean.yaml``.
    registry
        Loaded plugins, which tell the types of ports; by default those that are installed.
    file

    Returns
    -------
    text : str
    inner : str
        The text of the new graph file.

    Raises
    ------
    GraphError
        See `set_value`; or if a node that stays stands between two that go, if they name an axis
        that stays, or if the type of a port is not known.
    """
    registry = registry or Registry.installed()
    document = Document(text, file)
    return _Move(document, tuple(nodes), name, path, registry).texts()


class _Feed(NamedTuple):
    """What feeds a node that goes from one that stays.

    Attributes
    ----------
    use : Use
    path : Path
        The place of the whole reference.
    source : str
        The reference as JSON.
    """

    use: Use
    path: Path
    source: str


class _Move:
    def __init__(
        self,
        document: Document,
        nodes: tuple[str, ...],
        name: str,
        path: str,
        registry: Registry,
    ) -> None:
        for node in nodes:
            document.find(("nodes", node))
        if not nodes:
            raise document.error(0, "name the nodes that go into the new graph")
        if not is_graph_file(path):
            raise document.error(0, f"{quoted(path)} is no name of a graph file", "end it in .yaml")
        check_new_name(document, name)
        self._document = document
        self._data = document.data
        self._nodes = [node for node in document.data["nodes"] if node in nodes]
        self._name = name
        self._path = path
        self._registry = registry
        self._inside: list[Use] = []
        self._outside: list[Use] = []
        for use in uses(document.data, registry):
            is_inside = use.path[0] == "nodes" and use.path[1] in self._nodes
            (self._inside if is_inside else self._outside).append(use)
        self._entering = [
            self._feed(use)
            for use in self._inside
            if use.role is Role.SOURCE and use.name not in self._nodes
        ]

    def texts(self) -> tuple[str, str]:
        """Return the text of the graph, and that of the new graph file."""
        self._refuse_circle()
        self._refuse_axes_that_stay()
        feeds = self._feeds()
        values = self._values()
        outputs = self._outputs()
        inner = self._inner(feeds, values, outputs)
        entry: dict[str, object] = {"use": self._path}
        if feeds:
            entry["in"] = {port: json.loads(source) for source, port in feeds.items()}
        if values:
            entry["with"] = {name: f"${name}" for name in values}
        return self._outer(entry, outputs), inner

    def _outer(self, entry: Mapping[str, object], outputs: Mapping[str, str]) -> str:
        changes = []
        for use in self._outside:
            if use.name not in self._nodes or use.role is Role.VALUE:
                continue
            if use.role is Role.SOURCE:
                old = _text_at(self._data, use.path)
                pattern, new = re.compile(re.escape(old)), f"{self._name}.{outputs[old]}"
            else:
                pattern = pattern_of(use.name, use)
                new = f"{self._name}.{use.name}"
            changes.append(Change(use.path, pattern, new, use.is_key))
        file = self._document.file
        text = self._document.reword(changes)
        names = list(self._data["nodes"])
        place = names.index(self._nodes[0])
        before = names[place - 1] if place else None
        text = Document(text, file).put(("nodes", self._name), entry, before)
        for node in self._nodes:
            text = Document(text, file).remove(("nodes", node))
        return text

    def _inner(
        self, feeds: Mapping[str, str], values: Mapping[str, object], outputs: Mapping[str, str]
    ) -> str:
        types = {port: self._type_of(source) for source, port in feeds.items()}
        text = f"nodegraph: {FORMAT}\nnodes:\n"
        if self._document.is_block(("nodes",)):
            text += "".join(self._document.lines(("nodes", node)) for node in self._nodes)
        else:
            for node in self._nodes:
                text = Document(text, self._path).put(("nodes", node), self._data["nodes"][node])
        if types or values:
            text = Document(text, self._path).put(("inputs",), {**types, **values}, "nodegraph")
        text = Document(text, self._path).put(
            ("outputs",), {port: source for source, port in outputs.items()}
        )
        for feed in self._entering:
            text = Document(text, self._path).put(feed.path, f"${feeds[feed.source]}")
        return text

    def _feed(self, use: Use) -> _Feed:
        path = use.path[:-1] if use.path[-1] == "from" else use.path
        return _Feed(use, path, json.dumps(value_at(self._data, path)))

    def _feeds(self) -> dict[str, str]:
        """Return the port of the new graph for each source, which is a JSON text."""
        feeds: dict[str, str] = {}
        for feed in self._entering:
            port = _text_at(self._data, feed.use.path).removeprefix("$").replace(".", "_")
            feeds.setdefault(feed.source, free_name(port, {*feeds.values(), *self._nodes}))
        return feeds

    def _values(self) -> dict[str, object]:
        """Return the inputs and axes that settings take, with their present or first value."""
        spec = read_graph_text(self._document.text, self._document.file, pathlib.Path())
        values: dict[str, object] = {}
        for use in self._inside:
            if use.role is Role.VALUE:
                axis = spec.axes.get(use.name)
                known = mapping(self._data.get("inputs")).get(use.name)
                values[use.name] = (axis.values[0] if axis.values else "") if axis else known
        return values

    def _outputs(self) -> dict[str, str]:
        """Return the output of the new graph for each reference to a node that goes."""
        outputs: dict[str, str] = {}
        for use in self._outside:
            if use.role is Role.SOURCE and use.name in self._nodes:
                source = _text_at(self._data, use.path)
                outputs.setdefault(source, free_name(source.replace(".", "_"), outputs.values()))
        if not outputs:
            outputs[self._nodes[-1]] = self._nodes[-1]
        return outputs

    def _type_of(self, source: str) -> str:
        """Return the name of the type of the ports that a source feeds: the narrowest."""
        if str(json.loads(source)).startswith("$"):
            return str(self._data["inputs"][json.loads(source)[1:]])
        types = []
        for feed in self._entering:
            if feed.source == source:
                port = self._port(feed.use)
                if port is None:
                    message = (
                        f"the type of the port that {_text_at(self._data, feed.use.path)} feeds"
                    )
                    place = self._document.find(feed.use.path)
                    raise self._document.error(place, f"{message} is not known")
                types.append(port.type)
        narrowest = min(types, key=lambda type_: sum(issubclass(each, type_) for each in types))
        return narrowest.__name__

    def _port(self, use: Use) -> Port | None:
        """Return the port that a reference feeds, if its node is installed."""
        path = use.path
        begins = path.index("in")
        entry = value_at(self._data, path[:begins])
        name = path[begins + 1] if len(path) > begins + 1 and path[begins + 1] != "from" else None
        ports = (port for node in nodes_of(entry, self._registry) for port in node.inputs)
        return next((port for port in ports if name in (None, port.name)), None)

    def _refuse_circle(self) -> None:
        """Refuse if a node that stays reads one that goes, and feeds another."""
        readers = nx.DiGraph(
            (use.name, str(use.path[1]))
            for use in (*self._inside, *self._outside)
            if use.role is Role.SOURCE and use.path[0] == "nodes"
            if use.path[1] not in self._nodes
        )
        after = set().union(*(nx.descendants(readers, n) for n in self._nodes if n in readers))
        for use, _, _ in self._entering:
            if use.name in after:
                message = f"{quoted(use.name)} reads nodes that go, and feeds {use.path[1]}"
                hint = f"move {use.name} as well"
                raise self._document.error(self._document.find(use.path), message, hint)

    def _refuse_axes_that_stay(self) -> None:
        stay = {*mapping(self._data.get("axes")), *self._data["nodes"]} - {*self._nodes}
        for use in self._inside:
            if use.role is Role.AXIS and use.name in stay:
                message = f"{use.path[1]} names the axis {quoted(use.name)}, which stays outside"
                parent = use.path[:-1] if use.is_key else use.path
                raise self._document.error(self._document.find(parent), message)


def _text_at(data: Any, path: Path) -> str:
    return str(value_at(data, path))
