"""The edits that a page asks for, by name, with their arguments as text."""

from __future__ import annotations

import inspect
import pathlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from nodegraph import edit
from nodegraph.edit.document import Document, Path, value_at
from nodegraph.edit.uses import free_name, mapping, nodes_of, shown_at
from nodegraph.editor.links import Links
from nodegraph.errors import GraphError, NodegraphError, nearest
from nodegraph.graph.option_text import read_axis, read_value
from nodegraph.graphfile.keys import FORMAT
from nodegraph.graphfile.nodes import label_of
from nodegraph.plugin.registry import Registry

_KEYS = (str, int, float, bool)
_LISTS = ("path", "nodes")
"""Arguments that are lists of keys; the others are text."""


class Edits:
    """Edits of the text of one file.

    Parameters
    ----------
    registry
    path
        The graph file.
    """

    def __init__(self, registry: Registry, path: pathlib.Path) -> None:
        self._registry = registry
        self._path = path
        self._folder = path.parent
        self._file = path.name

    def named(self, name: str, arguments: Mapping[str, Any]) -> Callable[[str], str]:
        """Return the edit of a name: a function from text to text.

        Raises
        ------
        LookupError
            If there is none, or it has other arguments.
        """
        actions: dict[str, Callable[..., str]] = {
            "set": self._set,
            "add_node": self._add_node,
            "remove_node": self._remove_node,
            "rename": self._rename,
            "connect": self._connect,
            "disconnect": self._disconnect,
            "add_alternative": self._add_alternative,
            "remove_alternative": self._remove_alternative,
            "set_axis": self._set_axis,
            "show": self._show,
            "hide": self._hide,
            "move_to_graph": self._move_to_graph,
        }
        if name not in actions:
            raise LookupError(f"no action {name!r}; {nearest(name, actions)}")
        action = actions[name]
        try:
            inspect.signature(action).bind("", **arguments)
        except TypeError as error:
            raise LookupError(f"{name}: {error}") from error
        for key, value in arguments.items():
            if not (_is_path(value) if key in _LISTS else isinstance(value, str)):
                raise LookupError(f"{name}: {key} is of another type")
        return lambda text: action(text, **arguments)

    def _set(self, text: str, *, path: Path, value: str) -> str:
        """Write a setting as YAML, or remove it if that is empty."""
        if not value.strip():
            return edit.unset(text, path, file=self._file)
        document = Document(text, self._file)
        listed = value_at(document.data, path[:3])
        if isinstance(listed, list) and "alternatives" in path[2:-1]:  # names have no settings
            text = document.put(path[:3], {label_of(str(use)): {"use": use} for use in listed})
        return edit.set_value(text, path, read_value(str(path[-1]), value), file=self._file)

    def _add_node(self, text: str, *, name: str, use: str, after: str) -> str:
        """Add a node behind another, which feeds it if it fits, or by one of its outputs.

        Other ports that need a value have it where the graph leaves no choice.
        """
        entry: dict[str, object] = {"use": use}
        with suppress(GraphError):  # the text is not YAML, which the edit will say
            if feed := Links(text, self._path, self._registry).wiring(use, after):
                entry["in"] = feed
        if not text.strip("\ufeff \r\n"):
            text = f"nodegraph: {FORMAT}\nnodes:\n  {name}: {{}}\n"
            return edit.set_value(text, ("nodes", name), entry, file=self._file)
        behind = after.partition(".")[0]
        return edit.add_node(text, name, entry, after=behind, file=self._file)

    def _remove_node(self, text: str, *, name: str) -> str:
        return edit.remove_node(text, name, registry=self._registry, file=self._file)

    def _rename(self, text: str, *, old: str, new: str) -> str:
        return edit.rename(text, old, new, registry=self._registry, file=self._file)

    def _connect(self, text: str, *, node: str, port: str, source: str) -> str:
        return edit.connect(text, node, source, port=port, registry=self._registry, file=self._file)

    def _disconnect(self, text: str, *, node: str, port: str) -> str:
        """Remove what feeds a port, whether it is named there or is the first."""
        wiring = value_at(Document(text, self._file).data, ("nodes", node, "in"))
        named = port if isinstance(wiring, dict) and port in wiring else ""
        return edit.disconnect(text, node, port=named, file=self._file)

    def _add_alternative(self, text: str, *, node: str, use: str) -> str:
        label = self._free_label(text, node, label_of(use))
        return edit.add_alternative(text, node, label, {"use": use}, file=self._file)

    def _free_label(self, text: str, node: str, label: str) -> str:
        """Return a label, with a number if a node has it already."""
        entry = value_at(Document(text, self._file).data, ("nodes", node))
        alternatives = mapping(entry).get("alternatives")
        taken = {label_of(each.name) for each in nodes_of(entry, self._registry)}
        taken |= {str(each) for each in mapping(alternatives)}
        return free_name(label, taken)

    def _remove_alternative(self, text: str, *, node: str, label: str) -> str:
        return edit.remove_alternative(text, node, label, file=self._file)

    def _set_axis(self, text: str, *, name: str, labels: str) -> str:
        if not labels.strip():
            return edit.unset(text, ("axes", name), file=self._file)
        value = read_axis(name, labels)
        return edit.set_axis(text, name, value, file=self._file)

    def _show(self, text: str, *, node: str) -> str:
        """Show what a node gives in the report, behind what is there."""
        there = value_at(Document(text, self._file).data, ("report",))
        if isinstance(there, list) and there:
            return edit.set_value(text, ("report", len(there)), node, file=self._file)
        return edit.set_value(text, ("report",), [node], file=self._file)

    def _hide(self, text: str, *, node: str) -> str:
        """Leave a node out of the report."""
        for place in reversed(shown_at(Document(text, self._file).data, node)):
            text = edit.unset(text, ("report", place), file=self._file)
        return text

    def _move_to_graph(self, text: str, *, nodes: list[str], name: str, into: str) -> str:
        """Move nodes into a new graph file below the folder of this, which is written at once."""
        folder = self._folder.resolve()
        target = (folder / into).resolve()
        if not target.is_relative_to(folder):
            raise NodegraphError(f"{into} is outside the folder of {self._file}")
        if target.exists():
            raise NodegraphError(f"{into} is there already; name a new file")
        text, inner = edit.move_to_graph(
            text, nodes, name, into, registry=self._registry, file=self._file
        )
        target.parent.mkdir(parents=True, exist_ok=True)
        with target.open("x", encoding="utf-8", newline="") as file:
            file.write(inner)
        return text


def _is_path(value: object) -> bool:
    """Return whether a value is keys of mappings, from the outermost."""
    return isinstance(value, list) and value != [] and all(type(key) in _KEYS for key in value)
