"""The places of a graph file where the name of a node, an axis or an input stands."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from enum import Enum, auto
from itertools import chain, count
from typing import Any, NamedTuple

from nodegraph.edit.document import Path
from nodegraph.errors import UnknownNodeError
from nodegraph.graphfile.keys import IDENTIFIER
from nodegraph.node.decorator import Node
from nodegraph.node.ports import ColumnOf
from nodegraph.plugin.registry import Registry

_NAME = re.compile(rf"\$?({IDENTIFIER})(\.|$)")
_AT = re.compile(rf"(?:\bat |, *)({IDENTIFIER})[\w.]*=")
SECTIONS = ("inputs", "axes", "nodes")
"""Whose keys share one namespace."""


class Role(Enum):
    """What a name stands for."""

    SOURCE = auto()
    """A node, or a port, from which a value flows."""
    VALUE = auto()
    """An input or an axis, ``$name``, whose value a setting takes."""
    AXIS = auto()


class Use(NamedTuple):
    """A place where a name stands.

    Attributes
    ----------
    path : Path
        The place of the text in which it stands, or of the key that it is.
    name : str
    role : Role
    is_key : bool
    """

    path: Path
    name: str
    role: Role
    is_key: bool = False

    @property
    def is_read(self) -> bool:
        """Whether a node or an output reads it, and not the report alone."""
        return self.role is Role.SOURCE and self.path[0] in ("nodes", "outputs")


def pattern_of(name: str, use: Use | None = None) -> re.Pattern[str]:
    """Return the expression of a name where it is used, or, without a use, where it is defined."""
    if use is not None and use.path[-1] == "answer":  # in which it is a word, too
        return re.compile(rf"(?<=[ ,]){re.escape(name)}(?=[\w.]*=)")
    return re.compile(rf"(?<![\w.]){re.escape(name)}(?!\w)")


def uses(data: dict[str, Any], registry: Registry) -> Iterator[Use]:
    """Yield every place where a name stands but those that define it.

    Parameters
    ----------
    data
        The plain data of a graph file.
    registry
        Tells which settings name axes.
    """
    for section in ("known", "report"):
        for position, item in enumerate(_list(data.get(section))):
            yield from _reference((section, position), item)
            if isinstance(item, dict) and isinstance(item.get("answer"), str):
                for match in _AT.finditer(item["answer"]):
                    yield Use((section, position, "answer"), match[1], Role.AXIS)
    for name, item in mapping(data.get("outputs")).items():
        yield from _reference(("outputs", name), item)
    for position, item in enumerate(_list(data.get("skip"))):
        yield from _keys(("skip", position), item)
    for name, node in mapping(data.get("nodes")).items():
        yield from _node(("nodes", name), mapping(node), registry)


def nodes_of(
    entry: object, registry: Registry, graphs: Mapping[str, Node] | None = None
) -> Iterator[Node]:
    """Yield the nodes that an entry of ``nodes``, or one of its alternatives, uses.

    These are installed, or stand for graph files, by what ``use`` names.
    """
    if isinstance(entry, str):
        entry = {"alternatives" if entry.endswith(".*") else "use": entry}
    alternatives = mapping(entry).get("alternatives")
    if isinstance(alternatives, str):
        for each in registry.family(alternatives.removesuffix(".*")).values():
            yield each.node
    for label, method in mapping(alternatives).items():
        yield from nodes_of(method if mapping(method).get("use") else label, registry, graphs)
    for use in map(str, (mapping(entry).get("use"), *_list(alternatives))):
        if graphs is not None and use in graphs:
            yield graphs[use]
            continue
        with suppress(UnknownNodeError):
            yield registry.find(use).node


def shown_at(data: dict[str, Any], node: str) -> list[int]:
    """Return the places in ``report`` at which a node, or one of its outputs, stands."""
    entries = _list(mapping(data).get("report"))
    texts = (mapping(entry).get("show", entry) for entry in entries)
    return [place for place, text in enumerate(texts) if str(text).partition(".")[0] == node]


def _node(path: Path, node: dict[str, Any], registry: Registry) -> Iterator[Use]:
    for position, axis in enumerate(_list(node.get("over"))):
        yield from _text((*path, "over", position), axis, Role.AXIS)
    for label, method in mapping(node.get("alternatives")).items():
        yield from _method((*path, "alternatives", label), mapping(method), registry)
    yield from _method(path, node, registry)


def _method(path: Path, method: dict[str, Any], registry: Registry) -> Iterator[Use]:
    wiring = method.get("in")
    if isinstance(wiring, dict) and "from" not in wiring:
        for port, feed in wiring.items():
            inner = (*path, "in", port)
            if isinstance(feed, dict) and "from" not in feed:
                for label, source in feed.items():
                    yield from _reference((*inner, label), source)
            else:
                yield from _reference(inner, feed)
    else:
        yield from _reference((*path, "in"), wiring)
    naming = {
        name
        for node in nodes_of(method, registry)
        for name, setting in node.settings.items()
        if isinstance(setting.names, ColumnOf) and setting.names.or_axis
    }
    for name, value in mapping(method.get("with")).items():
        yield from _setting((*path, "with", name), value, name in naming)


def _setting(path: Path, value: object, names_axes: bool) -> Iterator[Use]:
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _setting((*path, key), each, False)
    elif isinstance(value, list):
        for position, each in enumerate(value):
            yield from _setting((*path, position), each, names_axes)
    elif isinstance(value, str) and (value.startswith("$") or names_axes):
        yield from _text(path, value, Role.VALUE if value.startswith("$") else Role.AXIS)


def _reference(path: Path, item: object) -> Iterator[Use]:
    if isinstance(item, dict):
        for key in ("from", "show"):
            yield from _reference((*path, key), item.get(key))
        yield from _keys((*path, "at"), item.get("at"))
    elif isinstance(item, str):
        yield from _text(path, item, Role.SOURCE)


def _keys(path: Path, item: object) -> Iterator[Use]:
    for axis in mapping(item):
        if isinstance(axis, str) and (match := _NAME.match(axis)):
            yield Use((*path, axis), match[1], Role.AXIS, is_key=True)


def _text(path: Path, text: object, role: Role) -> Iterator[Use]:
    if isinstance(text, str) and (match := _NAME.match(text)):
        yield Use(path, match[1], role)


def free_name(name: str, taken: Collection[str]) -> str:
    """Return a name, with a number if it is taken."""
    numbered = (f"{name}_{number}" for number in count(2))
    return next(each for each in chain([name], numbered) if each not in taken)


def mapping(value: object) -> dict[Any, Any]:
    """Return a mapping, or an empty one for anything else."""
    return value if isinstance(value, dict) else {}


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []
