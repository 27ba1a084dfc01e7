"""What can be done to a graph file: each action takes its text and returns the changed text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from nodegraph.edit.document import Change, Document, Path, value_at
from nodegraph.edit.uses import SECTIONS, Role, mapping, nodes_of, pattern_of, uses
from nodegraph.errors import nearest, quoted
from nodegraph.graphfile.keys import IDENTIFIER, IDENTIFIER_HINT, TOP_LEVEL
from nodegraph.graphfile.nodes import label_of
from nodegraph.plugin.registry import Registry

_PRUNED = ("with", "in", "at", "over", "inputs", "axes", "outputs", "skip", "known", "requires")
"""Keys that go with the last of what they hold."""


def set_value(text: str, path: Path, value: object, *, file: str = "graph") -> str:
    """Write a value at a path: ``("nodes", "fill", "with", "neighbours")``.

    Mappings that are missing on the way are added, and so is an item behind the last of a list.

    Parameters
    ----------
    text
        The text of the graph file.
    path
        Keys of mappings and positions in lists, from the outermost.
    value
        Plain data.
    file
        The name of the file in messages.

    Raises
    ------
    GraphError
        If the text is not YAML, or the edit cannot be written there: through an alias, to what an
        alias stands for, or where the result would say something else than intended.
    """
    document = Document(text, file)
    return document.put(path, value, _section_before(document, path))


def unset(text: str, path: Path, *, file: str = "graph") -> str:
    """Remove what is at a path, and ``with``, ``in`` or another section that it leaves empty.

    See `set_value` for the parameters and errors.
    """
    document = Document(text, file)
    path = tuple(path)
    while len(path) > 1 and path[-2] in _PRUNED and len(document.find(path[:-1]).parts) == 1:
        path = path[:-1]
    return document.remove(path)


def add_node(
    text: str, name: str, node: Mapping[str, object], *, after: str = "", file: str = "graph"
) -> str:
    """Add a node behind the last, or behind another.

    Parameters
    ----------
    text
    name
    node
        Its entry: ``{"use": "fill.muscle", "in": "gaps"}``.
    after
        The node behind which it stands.
    file

    Raises
    ------
    GraphError
        See `set_value`; or if the name is taken or cannot be one.
    """
    document = Document(text, file)
    check_new_name(document, name)
    return document.put(("nodes", name), dict(node), after or None)


def remove_node(
    text: str, name: str, *, registry: Registry | None = None, file: str = "graph"
) -> str:
    """Remove a node, and its entries in ``report`` and ``known``.

    Parameters
    ----------
    text
    name
    registry
        Loaded plugins; by default those that are installed.
    file

    Raises
    ------
    GraphError
        See `set_value`; or if another node or an output reads it.
    """
    document = Document(text, file)
    document.find(("nodes", name))
    own = ("nodes", name)
    read = [
        use for use in uses(document.data, registry or Registry.installed()) if use.name == name
    ]
    feeding = [use for use in read if use.is_read and tuple(use.path[:2]) != own]
    if feeding:
        readers = ", ".join(dict.fromkeys(str(use.path[1]) for use in feeding))
        message = f"{quoted(name)} feeds {readers}"
        raise document.error(document.find(feeding[0].path), message, "disconnect these first")
    shown = {use.path[:2] for use in read if use.role is Role.SOURCE and not use.is_read}
    for path in sorted(shown, key=str, reverse=True):
        text = unset(text, path, file=file)
    return Document(text, file).remove(("nodes", name))


def rename(
    text: str, old: str, new: str, *, registry: Registry | None = None, file: str = "graph"
) -> str:
    """Give a node, an axis or an input another name, wherever it is named.

    Prose, as in ``title``, ``notes`` and comments, stays as it is.

    Parameters
    ----------
    text
    old, new
    registry
        Loaded plugins, which tell what settings name axes; by default those that are installed.
    file

    Raises
    ------
    GraphError
        See `set_value`; or if there is no such name, or the new one is taken or cannot be one.
    """
    document = Document(text, file)
    defined = [(section, old) for section in SECTIONS if old in _section(document, section)]
    if not defined:
        known = [name for section in SECTIONS for name in _section(document, section)]
        raise document.error(0, f"no node, axis or input {quoted(old)}", nearest(old, known))
    check_new_name(document, new)
    changes = [Change(path, pattern_of(old), new, is_key=True) for path in defined]
    for use in uses(document.data, registry or Registry.installed()):
        if use.name == old:
            changes.append(Change(use.path, pattern_of(old, use), new, use.is_key))
    return document.reword(changes)


def connect(
    text: str,
    node: str,
    source: str | Mapping[str, object],
    *,
    port: str = "",
    registry: Registry | None = None,
    file: str = "graph",
) -> str:
    """Feed a port of a node, in place of what feeds it.

    Parameters
    ----------
    text
    node
    source
        ``node``, ``node.port`` or ``{"from": ..., "at": ...}``.
    port
        By default the first.
    registry
        Loaded plugins, which tell a node's first port; by default those that are installed.
    file

    Raises
    ------
    GraphError
        See `set_value`; or if the first port has to be named and is not known.
    """
    document = Document(text, file)
    path = _wiring_path(document, node)
    value = dict(source) if isinstance(source, Mapping) else source
    there = value_at(document.data, path)
    is_named = isinstance(there, dict) and "from" not in there
    if there is None and not port:
        return document.put(path, value, _behind(document, path))
    if is_named and port:
        return document.put((*path, port), value)
    first = _first_port(document, node, registry or Registry.installed())
    port = port or first
    if not port:
        message = f"the first port of {quoted(node)} is not known"
        raise document.error(document.find(("nodes", node)), message, "name the port")
    if is_named:
        return document.put((*path, port), value)
    if there is not None and port == first:
        return document.put(path, value)
    if there is not None and not first:
        message = f"the port of {quoted(node)} that is fed already is not known"
        raise document.error(document.find(path), message, "write in: {port: source}")
    feeds = {port: value} if there is None else {first: there, port: value}
    return document.put(path, feeds, _behind(document, path))


def disconnect(text: str, node: str, *, port: str = "", file: str = "graph") -> str:
    """Remove what feeds a port; see `connect`.

    Without a port, all that feeds the node is removed.
    """
    path = _wiring_path(Document(text, file), node)
    return unset(text, (*path, port) if port else path, file=file)


def add_alternative(
    text: str,
    node: str,
    label: str,
    method: Mapping[str, object],
    *,
    file: str = "graph",
) -> str:
    """Set a method beside those of a node, which becomes an axis if it had one method.

    The settings of a node with one method become those of its first alternative, since the other
    may not have them; what feeds it feeds both.

    Parameters
    ----------
    text
    node
    label
        The label of the new alternative.
    method
        Its entry: ``{"use": "fill.ridge", "with": {"neighbours": 8}}``.
    file

    Raises
    ------
    GraphError
        See `set_value`; or if the label is taken.
    """
    document = Document(text, file)
    path = ("nodes", node, "alternatives")
    document.find(path[:2])
    known, labels = value_at(document.data, path), _labels(document, path)
    if label in labels:
        here = next(each for each in ((*path, label), path, path[:2]) if document.has(each))
        raise document.error(document.find(here), f"{quoted(label)} is there already")
    entry = dict(method)
    if isinstance(known, dict):
        return document.put((*path, label), entry)
    if isinstance(known, list):
        if entry.keys() == {"use"} and label_of(str(entry["use"])) == label:
            return document.put((*path, len(known)), entry["use"])
        listed = {each: {"use": use} for each, use in zip(labels, known, strict=True)}
        return document.put(path, {**listed, label: entry})
    if isinstance(known, str):
        return document.put(path, {known: {}, label: entry})
    use, settings = (value_at(document.data, (*path[:2], key)) for key in ("use", "with"))
    first = {"use": use} | ({"with": settings} if settings else {})
    text = document.put(path, {label_of(str(use)): first, label: entry}, "use")
    if settings is not None:
        text = Document(text, file).remove((*path[:2], "with"))
    return Document(text, file).remove((*path[:2], "use"))


def remove_alternative(text: str, node: str, label: str, *, file: str = "graph") -> str:
    """Remove one of the methods of a node.

    Raises
    ------
    GraphError
        See `set_value`; or if there is no such alternative, or a family stands for it.
    """
    document = Document(text, file)
    path = ("nodes", node, "alternatives")
    known, labels = value_at(document.data, path), _labels(document, path)
    if not isinstance(known, (dict, list)) or label not in labels:
        where = document.find(path if document.has(path) else path[:2])
        hint = "list those to keep" if isinstance(known, str) else nearest(label, labels)
        raise document.error(where, f"{node} does not list {quoted(label)}", hint)
    key = labels.index(label) if isinstance(known, list) else label
    return document.remove((*path, key))


def set_axis(text: str, name: str, labels: object, *, file: str = "graph") -> str:
    """Write the labels of an axis, which is added if it is new.

    Parameters
    ----------
    text
    name
    labels
        A list, labels with values, or a generator such as ``{"count": 20}``.
    file

    Raises
    ------
    GraphError
        See `set_value`; or if the name is that of a node or an input.
    """
    document = Document(text, file)
    if name not in _section(document, "axes"):
        check_new_name(document, name)
    path = ("axes", name)
    return document.put(path, labels, _section_before(document, path))


def _labels(document: Document, path: Path) -> list[str]:
    """Return the labels of the alternatives at a path that are listed; of one method, its own."""
    known = value_at(document.data, path)
    if isinstance(known, dict):
        return list(known)
    if isinstance(known, str):
        return []
    uses_of = known or [value_at(document.data, (*path[:-1], "use"))]
    return [label_of(str(use)) for use in uses_of]


def check_new_name(document: Document, name: str) -> None:
    """Refuse a name that is taken, or cannot be one."""
    if not re.fullmatch(IDENTIFIER, name):
        raise document.error(0, f"{quoted(name)} cannot be a name", IDENTIFIER_HINT)
    for section in SECTIONS:
        if name in _section(document, section):
            where = document.find((section, name))
            raise document.error(where, f"{quoted(name)} is a name already, in {quoted(section)}")


def _section(document: Document, section: str) -> Mapping[Any, Any]:
    return mapping(value_at(document.data, (section,)))


def _section_before(document: Document, path: Path) -> str | None:
    """Return the section of the file behind which a new one belongs."""
    data = document.data
    order = list(TOP_LEVEL)
    if not isinstance(data, dict) or path[0] in data or path[0] not in order:
        return None
    before = order[: order.index(str(path[0]))]
    return next((name for name in reversed(before) if name in data), None)


def _behind(document: Document, path: Path) -> str | None:
    """Return the key behind which ``in`` stands."""
    there = value_at(document.data, path[:-1])
    return "use" if isinstance(there, dict) and "use" in there else None


def _wiring_path(document: Document, node: str) -> Path:
    document.find(("nodes", node))
    return ("nodes", node, "in")


def _first_port(document: Document, node: str, registry: Registry) -> str:
    """Return the first port of a node's method, if that is installed."""
    entry = value_at(document.data, ("nodes", node))
    ports = (port.name for each in nodes_of(entry, registry) for port in each.inputs)
    return next(ports, "")
