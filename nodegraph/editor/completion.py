"""What may stand at a place of a graph file, and what it means."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from nodegraph.editor.outline import ITEM, Cursor, Outline, Path, cursor_in, outline_of
from nodegraph.graphfile.keys import (
    FIXED_REFERENCE,
    METHOD,
    NODE,
    PASS,
    REPORT_ENTRY,
    TOP_LEVEL,
    Key,
)
from nodegraph.graphfile.schema import about_node, names_of
from nodegraph.graphfile.settings_schema import settings_schema
from nodegraph.node.decorator import Node
from nodegraph.node.description import meanings, plain_summary_of
from nodegraph.plugin.registry import Registered, Registry

_IN_BRACKETS = re.compile(r"[\w$.*]*(?:[:-][\w$.*]+)*")
ABOUT_PASS = "Gives its input as it is."
_WORD_TYPES = {"boolean", "null"}


class Option(NamedTuple):
    """A word that may stand at a place.

    Attributes
    ----------
    word : str
    kind : str
        Said beside it.
    about : tuple of str
        Paragraphs.
    is_key : bool
        Whether a colon follows it.
    """

    word: str
    kind: str = ""
    about: tuple[str, ...] = ()
    is_key: bool = False


def options_at(text: str, index: int, registry: Registry) -> tuple[str, list[Option]]:
    """Return what stands before a place of the word there, and the words that may stand there."""
    cursor = cursor_in(text, index)
    options = _Options(outline_of(text), registry).at(cursor)
    return cursor.word, list(dict.fromkeys(options))


def about(text: str, index: int, registry: Registry) -> Option | None:
    """Return the word at a place of a text and what it means, if that is known."""
    rest = _IN_BRACKETS.match(text, index)
    cursor = cursor_in(text, rest.end() if rest else index)
    if not cursor.word:
        return None
    options = _Options(outline_of(text), registry).at(cursor)
    return next((each for each in options if each.word == cursor.word and each.about), None)


def registered_of(uses: Iterable[str], registry: Registry) -> list[Registered]:
    """Return the installed nodes that are used by these names, or families."""
    found = {each.full_name: each for use in uses for each in registry.used(use)}
    return list(found.values())


class _Options:
    def __init__(self, outline: Outline, registry: Registry) -> None:
        self._outline = outline
        self._registry = registry

    def at(self, cursor: Cursor) -> Iterator[Option]:
        """Yield what may stand at a place."""
        if cursor.is_key:
            yield from self._keys_in(cursor.path)
        if not cursor.is_key or cursor.path[-1:] == (ITEM,):
            yield from self._values_at(cursor.path)

    def _keys_in(self, path: Path) -> Iterator[Option]:
        match path:
            case ():
                yield from _keys(TOP_LEVEL)
            case ("nodes",):
                yield from self._known_nodes()
            case ("nodes", _):
                yield from _keys(NODE)
            case ("nodes", _, "alternatives", label) if label != ITEM:
                yield from _keys(METHOD)
            case ("nodes", *_, "with"):
                yield from self._settings(path)
            case (*_, "at"):
                yield from self._axes(is_key=True)
            case ("nodes", *_, "in"):
                yield from self._ports(path)
            case ("report", "-"):
                yield from _keys(REPORT_ENTRY)

    def _values_at(self, path: Path) -> Iterator[Option]:
        match path:
            case ("nodes", *_, "use"):
                yield from self._installed()
                yield Option(PASS, "", (ABOUT_PASS,))
            case ("nodes", _, "alternatives") | ("nodes", _, "alternatives", "-"):
                yield from self._families()
                yield from self._installed()
            case ("nodes", *_, "over", "-"):
                yield from self._axes()
            case ("nodes", *_, "with", setting):
                yield from self._values(path[:-1], setting)
            case ("nodes", *_, "in") | ("nodes", *_, "in", _) | ("nodes", *_, "from"):
                yield from self._sources()
            case ("report" | "known", "-") | ("report", "-", "show") | ("outputs", _):
                yield from self._sources()

    def _of_entry(self, path: Path) -> list[Node]:
        """Return the nodes that the entry uses to which ``in`` or ``with`` belongs."""
        uses = self._outline.uses_below(path[:-1])
        return [each.node for each in registered_of(uses, self._registry)]

    def _known_nodes(self) -> Iterator[Option]:
        for name in self._outline.names("nodes"):
            used = registered_of(self._outline.uses_below(("nodes", name)), self._registry)
            yield Option(name, "node", tuple(_about_uses(used)), is_key=True)

    def _installed(self) -> Iterator[Option]:
        for registered, (name, *_) in names_of(self._registry).items():
            yield Option(name, registered.node.family, tuple(about_node(registered)))

    def _families(self) -> Iterator[Option]:
        for family in self._registry.families:
            methods = ", ".join(self._registry.family(family))
            yield Option(f"{family}.*", "family", (f"All methods of the family: {methods}.",))

    def _axes(self, *, is_key: bool = False) -> Iterator[Option]:
        for name in self._outline.names("axes"):
            yield Option(name, "axis", is_key=is_key)

    def _settings(self, path: Path) -> Iterator[Option]:
        for node in self._of_entry(path):
            for name, schema in settings_schema(node).items():
                yield Option(name, "setting", (str(schema["description"]),), is_key=True)

    def _values(self, path: Path, setting: str) -> Iterator[Option]:
        for node in self._of_entry(path):
            schema = settings_schema(node).get(setting, {})
            meaning = (str(schema["description"]),) if schema else ()
            for word in words_of(schema):
                yield Option(word, "", meaning)
        for section in ("axes", "inputs"):
            for name in self._outline.names(section):
                yield Option(f"${name}", section)

    def _ports(self, path: Path) -> Iterator[Option]:
        for node in self._of_entry(path):
            documented = meanings(node)
            for port in node.inputs:
                meaning = documented.get(port.name, "")
                yield Option(port.name, str(port), (meaning,) if meaning else (), is_key=True)
        yield from _keys(FIXED_REFERENCE)

    def _sources(self) -> Iterator[Option]:
        """Yield the nodes of the file, and their outputs where there are several."""
        for name in self._outline.names("nodes"):
            used = registered_of(self._outline.uses_below(("nodes", name)), self._registry)
            said = tuple(_about_uses(used))
            yield Option(name, "node", said)
            outputs = used[0].node.outputs if used else ()
            for port in outputs if len(outputs) > 1 else ():
                yield Option(f"{name}.{port.name}", port.kind, said)


def words_of(schema: Mapping[str, Any]) -> list[str]:
    """Return the words that a setting may be, if its schema lists any."""
    words: list[str] = []
    for option in schema.get("anyOf", [schema]):
        words += map(str, option.get("enum", ()))
        types = _types(option)
        words += ["true", "false"] * ("boolean" in types) + ["null"] * ("null" in types)
    return words


def is_closed(schema: Mapping[str, Any]) -> bool:
    """Return whether a setting can be nothing but one of its words, or a variable."""
    return all(
        "enum" in option or "$ref" in option or _types(option) <= _WORD_TYPES
        for option in schema.get("anyOf", [schema])
    )


def _types(option: Mapping[str, Any]) -> set[str]:
    """Return the types that an option allows, but for the text of a variable; all for any."""
    types = option.get("type", "any")
    named = {types} if isinstance(types, str) else set(types)
    return named - {"string"} if "pattern" in option else named


def _about_uses(used: list[Registered]) -> Iterator[str]:
    if len(used) == 1:
        yield used[0].node.name
        yield from about_node(used[0])
    else:
        for each in used:
            yield f"{each.node.name}: {plain_summary_of(each.node)}"


def _keys(keys: Mapping[str, Key]) -> Iterator[Option]:
    for name, key in keys.items():
        yield Option(name, "key", (key.meaning,), is_key=True)
