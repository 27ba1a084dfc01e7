"""YAML text -> values with their places.

Scalars are those of YAML 1.2: ``1e-3`` is a number, ``no`` is a word. Duplicate keys, tags,
exploding aliases and excessive nesting are refused. Reading is not recursive, so that no file can
exhaust the stack.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NoReturn

import yaml

from nodegraph.errors import GraphError, Place, Problem, Problems, listed, quoted

_MOST_DEPTH = 100
_TOO_DEEP = f"nested more than {_MOST_DEPTH} deep"
_MOST_VALUES = 1_000_000
_LONGEST_KEY = 1024  # of YAML
_MOST_DIGITS = 3000  # Python shows no number of more than 4300
_UNPRINTABLE = re.compile("[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_INTEGER = re.compile(r"[-+]?[0-9]+")
_OCTAL_OR_HEX = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"([-+]?)\.(inf|Inf|INF)")
_WORD = re.compile(r"[A-Za-z_][\w.]*(?=\s|$)")
_NO_SPACE = re.compile(r" *(?:- )?([A-Za-z_][\w.]*):[^\s/]")
_CONSTANTS = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}

_KEY = "while scanning a simple key"
_OPENED = {
    "while parsing a flow sequence": "this [ is not closed, or a comma is missing",
    "while parsing a flow mapping": "this { is not closed, or a comma is missing",
    "while scanning a quoted scalar": "this quote is not closed",
}
_BEGUN = _OPENED | {
    _KEY: "",
    "while scanning an alias": "a text that begins with * needs quotes",
    "while scanning for the next token": "a text that begins with this character needs quotes",
}
"""What a parser of YAML was reading, and what is wrong there."""
_FIRST_OF_NUMBERS = frozenset(".+-0123456789")
"""Characters with which a number begins."""

_NO_KEYS: Mapping[object, Place] = MappingProxyType({})
Parser: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(slots=True)
class Located:
    """A value and the place where it was written.

    Attributes
    ----------
    value : Any
        A scalar, a list of `Located`, or a mapping of scalars to `Located`.
    place : Place
    keys : dict
        For a mapping, where each key was written.
    """

    value: Any
    place: Place
    keys: Mapping[object, Place] = field(default_factory=lambda: _NO_KEYS)

    def plain(self) -> Any:
        """Return the value without its places."""
        if isinstance(self.value, dict):
            return {key: item.plain() for key, item in self.value.items()}
        if isinstance(self.value, list):
            return [item.plain() for item in self.value]
        return self.value


def read_yaml(text: str, file: str, problems: Problems | None = None) -> Located:
    """Return the value of a YAML document, every part with its place.

    Parameters
    ----------
    text
    file
        Its name in messages.
    problems
        Where duplicate keys are noted, of which the first counts. Without it they are raised.

    Raises
    ------
    GraphError
        If the text is not YAML, with file, line and column.
    """
    _refuse_unprintable(text, file)
    noted = Problems() if problems is None else problems
    try:
        root = _Parser(file, noted).parse(text)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = Place(file, mark.line + 1, mark.column + 1) if mark else Place(file, 1, 1)
        if "nesting depth" in (error.problem or ""):  # PyYAML has a bound, too
            noted.add(place, _TOO_DEEP)
        else:
            place, reason = _reason(error, text, place)
            noted.add(place, f"this is not YAML: {reason}")
        raise GraphError(noted.all()) from error
    except yaml.YAMLError as error:
        noted.add(Place(file, 1, 1), f"this is not YAML: {error}")
        raise GraphError(noted.all()) from error
    if problems is None:
        noted.raise_any()
    return root


def _reason(error: yaml.MarkedYAMLError, text: str, place: Place) -> tuple[Place, str]:
    """Return what is wrong, and where: a parser notices some mistakes lines later."""
    lines = text.splitlines()
    line = "".join(lines[place.line - 1 : place.line])
    if line[place.column - 1 : place.column] == "\t":
        return place, "a tab; indent with spaces"
    if error.context in _BEGUN and (start := error.context_mark):
        before = place._replace(line=start.line + 1, column=start.column + 1)
        if error.context == _KEY:
            return before, _no_colon(lines[start.line][start.column :])
        end = f", up to line {place.line}, column {place.column}"
        return before, f"{_BEGUN[error.context]}{end if error.context in _OPENED else ''}"
    problem = error.problem or ""
    if problem.startswith("mapping values are not allowed"):
        return _no_mapping(lines, place)
    if problem == "did not find expected key" and (start := error.context_mark):
        return place, _misaligned(
            line, f"the mapping from line {start.line + 1} on by {start.column}"
        )
    return place, ", ".join(part for part in (error.context, error.problem) if part)


def _no_mapping(lines: Sequence[str], place: Place) -> tuple[Place, str]:
    """Return why a colon is where no value of a mapping can begin, and where that shows."""
    line = lines[place.line - 1]
    if ": " in line[: place.column - 1]:
        return place, "a second ': ' in a value; quote a text that contains one: \"a: b\""
    if place.column - 1 - _indent(line) > _LONGEST_KEY:
        return place, f"a key of more than {_LONGEST_KEY:,} characters"
    above = "".join(lines[place.line - 2 : place.line - 1])
    if match := _NO_SPACE.match(above):
        before = place._replace(line=place.line - 1, column=match.end())
        return before, f"no space after the colon; write '{match[1]}: ...'"
    if ":" not in above and _begins_value(lines[: place.line - 1], line):
        before = place._replace(line=place.line - 1, column=_indent(above) + 1)
        return before, _no_colon(above)
    if _indent(line) == _indent(above):
        return place, "': ' in a text that continues from the line above"
    return place, _misaligned(line, f"the one above by {_indent(above)}")


def _begins_value(before: Sequence[str], line: str) -> bool:
    """Return whether the last of the lines before a line begins a value, or a mapping's key."""
    *earlier, above = before or [""]
    ends_key = bool(earlier) and earlier[-1].rstrip().endswith(":")
    return _indent(above) == 0 or _indent(above) < _indent(line) or ends_key


def _no_colon(line: str) -> str:
    text = line.strip().removeprefix("- ")
    key = _WORD.match(text)
    return f"no colon after {quoted(key[0])}" if key else f"no colon follows {quoted(text)}"


def _misaligned(line: str, other: str) -> str:
    return (
        f"this line is indented by {_indent(line)}, {other}; keys of one mapping begin in the same "
        "column"
    )


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def scalar(text: str) -> Any:
    """Return the value of an unquoted scalar: null, a boolean, a number, or the text itself."""
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if text[0] not in _FIRST_OF_NUMBERS:
        return text
    if _INTEGER.fullmatch(text):
        return int(text) if len(text) < _MOST_DIGITS else text
    if _OCTAL_OR_HEX.fullmatch(text):
        return int(text, 0) if len(text) < _MOST_DIGITS else text
    if _FLOAT.fullmatch(text):
        return float(text)
    infinite = _INFINITE.fullmatch(text)
    return float(f"{infinite[1]}inf") if infinite else text


def _refuse_unprintable(text: str, file: str) -> None:
    match = _UNPRINTABLE.search(text)
    if match:
        line = text.count("\n", 0, match.start()) + 1
        place = Place(file, line, match.start() - text.rfind("\n", 0, match.start()))
        message = f"this is not YAML: the character {quoted(match[0])} is not allowed"
        raise GraphError([Problem(place, message)])


@dataclass(slots=True)
class _Open:
    """A list or mapping that is being read, with its size and height including aliases."""

    item: Located
    keys: dict[object, Place]
    anchor: str | None
    key: object = None
    has_key: bool = False
    size: int = 1
    height: int = 1


class _Parser:
    """Builds values from the events of PyYAML's parser."""

    def __init__(self, file: str, problems: Problems) -> None:
        self._file = file
        self._open: list[_Open] = []
        self._anchors: dict[str, tuple[Located, int, int]] = {}
        self._problems = problems
        self._root: Located | None = None

    def parse(self, text: str) -> Located:
        handlers: Mapping[type, Callable[[Any], None]] = {
            yaml.ScalarEvent: self._scalar,
            yaml.MappingStartEvent: self._start,
            yaml.SequenceStartEvent: self._start,
            yaml.MappingEndEvent: self._end,
            yaml.SequenceEndEvent: self._end,
            yaml.AliasEvent: self._alias,
            yaml.DocumentStartEvent: self._document,
        }
        next_event = Parser(text).get_event
        while (event := next_event()) is not None:
            if handle := handlers.get(type(event)):
                handle(event)
        return self._root or Located(None, Place(self._file, 1, 1))

    def _document(self, event: yaml.Event) -> None:
        if self._root is not None:
            self._fail(self._place(event), "a second document; a graph file has one")

    def _scalar(self, event: yaml.ScalarEvent) -> None:
        place = self._place(event)
        if event.tag is not None:
            self._refuse_tag(event, place)
        value = scalar(event.value) if event.implicit[0] else event.value
        item = Located(value, place, _NO_KEYS)
        self._add(item, 1, 0)
        if event.anchor is not None:
            self._anchors[event.anchor] = (item, 1, 0)

    def _start(self, event: yaml.CollectionStartEvent) -> None:
        place = self._place(event)
        self._refuse_tag(event, place)
        self._refuse_depth(place, len(self._open) + 1)
        empty: object = {} if isinstance(event, yaml.MappingStartEvent) else []
        keys: dict[object, Place] = {}
        self._open.append(_Open(Located(empty, place, keys), keys, event.anchor))

    def _end(self, event: object) -> None:
        closed = self._open.pop()
        self._add(closed.item, closed.size, closed.height)
        if closed.anchor is not None:
            self._anchors[closed.anchor] = (closed.item, closed.size, closed.height)

    def _alias(self, event: yaml.AliasEvent) -> None:
        place = self._place(event)
        if (target := self._anchors.get(event.anchor or "")) is None:
            self._fail(
                place, f"alias *{listed([event.anchor])} stands before, or inside, its anchor"
            )
        item, size, height = target
        self._refuse_depth(place, len(self._open) + height)
        self._add(Located(item.value, place, item.keys), size, height)

    def _refuse_depth(self, place: Place, depth: int) -> None:
        if depth > _MOST_DEPTH:
            self._fail(place, _TOO_DEEP)

    def _add(self, item: Located, size: int, height: int) -> None:
        if not self._open:
            self._root = item
            return
        parent = self._open[-1]
        parent.size += size
        if height >= parent.height:
            parent.height = height + 1
        if parent.size > _MOST_VALUES:
            self._fail(item.place, f"aliases unfold to more than {_MOST_VALUES:,} values")
        into = parent.item.value
        if type(into) is list:
            into.append(item)
        elif parent.has_key:
            into.setdefault(parent.key, item)
            parent.has_key = False
        else:
            if height:
                self._fail(item.place, "a key must be one word or number")
            first = parent.keys.setdefault(item.value, item.place)
            if first is not item.place:
                message = f"duplicate key {quoted(item.value)}; first in line {first.line}"
                self._problems.add(item.place, message)
            parent.key, parent.has_key = item.value, True

    def _refuse_tag(
        self, event: yaml.ScalarEvent | yaml.CollectionStartEvent, place: Place
    ) -> None:
        if event.tag not in (None, "!"):
            self._fail(
                place, f"tag {quoted(event.tag)} has no meaning in a graph file; leave it out"
            )

    def _place(self, event: Any) -> Place:
        mark = event.start_mark
        return Place(self._file, mark.line + 1, mark.column + 1)

    def _fail(self, place: Place, message: str) -> NoReturn:
        raise GraphError([*self._problems.all(), Problem(place, message)])


def located(value: object, place: Place) -> Located:
    """Return plain data as if all of it were written at one place."""
    if isinstance(value, dict):
        items = {key: located(item, place) for key, item in value.items()}
        return Located(items, place, dict.fromkeys(items, place))
    if isinstance(value, (list, tuple, range)):
        return Located([located(item, place) for item in value], place)
    return Located(value, place)
