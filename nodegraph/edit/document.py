"""The text of a graph file as a tree with spans, and patches that change its data and no more."""

from __future__ import annotations

import copy
import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import yaml

from nodegraph.errors import GraphError, Place, Problem, nearest, quoted
from nodegraph.graphfile.yaml_text import Parser, read_yaml, scalar

Path = Sequence[str | int | float | bool]
"""Keys of mappings and positions in lists, from the outermost: ``("nodes", "fill", "with")``."""

_WIDTH = 100
"""Columns up to which a new mapping or list is written in one line."""
_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_PLAIN = re.compile(r"[\w$/.][\w$/.:+()%~^*=<>@|; -]*")
_ESCAPED = re.compile("[\x7f-\x9f\u2028\u2029\ufeff\ufffe\uffff]")


class Patch(NamedTuple):
    """Text that takes the place of a span."""

    start: int
    end: int
    text: str


class Change(NamedTuple):
    """A word that changes in a key or in a text."""

    path: Path
    pattern: re.Pattern[str]
    new: str
    is_key: bool = False


@dataclass(slots=True)
class TextNode:
    """A value in the text.

    Attributes
    ----------
    start, end : int
        Its span, from its anchor to its last character; of a block, to that of its last part.
    kind : type
        `dict`, `list`, or `str` for a scalar.
    is_flow : bool
        Whether brackets enclose it.
    anchor : str
        Empty for none.
    alias : TextNode or None
        The node that it stands for.
    keys : list of TextNode
        The keys of a mapping.
    parts : list of TextNode
    """

    start: int
    end: int
    kind: type
    is_flow: bool = False
    anchor: str = ""
    alias: TextNode | None = None
    value: object = None
    keys: list[TextNode] = field(default_factory=list)
    parts: list[TextNode] = field(default_factory=list)

    @property
    def target(self) -> TextNode:
        """The node, or that which an alias stands for."""
        return self.alias or self

    def place(self, key: object) -> int | None:
        """Return the place of a key, or of an item of a list, among the parts."""
        if self.kind is list:
            return key if isinstance(key, int) and 0 <= key < len(self.parts) else None
        return next((at for at, each in enumerate(self.keys) if each.value == key), None)

    def walk(self) -> Iterator[TextNode]:
        """Yield the node and all within it."""
        pending = [self]
        while pending:
            node = pending.pop()
            yield node
            pending += node.parts


class Document:
    """The text of a graph file, and where each of its values stands.

    Parameters
    ----------
    text
    file
        Its name in messages.

    Raises
    ------
    GraphError
        If the text is not YAML.
    """

    def __init__(self, text: str, file: str) -> None:
        self.file = file
        self.data: Any = read_yaml(text, file).plain()
        self._mark = "\ufeff" if text.startswith("\ufeff") else ""
        self.text = text.removeprefix(self._mark)
        self._root = self._read()
        first = _BREAK.search(self.text)
        self._newline = first[0] if first else "\n"
        self._aliases = [node for node in self._root.walk() if node.alias]

    def error(self, at: TextNode | int, message: str, hint: str = "") -> GraphError:
        """Return an error with its place."""
        place = self._place(at if isinstance(at, int) else at.start)
        return GraphError([Problem(place, message, hint)])

    def find(self, path: Path) -> TextNode:
        """Return the node at a path; an alias stands for what has its anchor."""
        return self._written_at(path).target

    def has(self, path: Path) -> bool:
        """Return whether there is a value at a path."""
        return len(self._along(path)) > len(path)

    def lines(self, path: Path) -> str:
        """Return the lines of a key of a block, as they stand."""
        key, node = self._key(path), self._written_at(path)
        start = key.start - self._column(key.start)
        return self.text[start : self._line_end(node.end)] + self._newline

    def is_block(self, path: Path) -> bool:
        """Return whether what is at a path has a line for each of its keys."""
        return not self.find(path).is_flow and not self._is_in_flow(path)

    def put(self, path: Path, value: object, after: object = None) -> str:
        """Return the text with a value at a path, in place of what is there.

        Mappings that are missing on the way are added. A new key, or the outermost of these, stands
        last, or after another.
        """
        path = tuple(path)
        while len(path) > 1 and value_at(self.data, path[:-1]) is None:
            path, value = path[:-1], {path[-1]: value}
        exists = self.has(path)
        self._refuse_shared(path if exists else path[:-1], whole=exists)
        intended = copy.deepcopy(self.data)
        parent, key = value_at(intended, path[:-1]), path[-1]
        if isinstance(parent, dict):
            keys = list(parent)
            following = keys[keys.index(after) + 1 :] if after in keys and key not in keys else []
            moved = {name: parent.pop(name) for name in following}
            parent.update({key: value, **moved})
        elif isinstance(parent, list) and isinstance(key, int) and exists:
            parent[key] = value
        elif isinstance(parent, list) and key == len(parent):
            parent.append(value)
        else:
            where = ".".join(map(str, path[:-1]))
            raise self.error(self.find(path[:-1]), f"{where} has no place for {quoted(key)}")
        patches = self._replace(path, value) if exists else self._insert(path, value, after)
        return self.patched(patches, intended)

    def remove(self, path: Path) -> str:
        """Return the text without what is at a path."""
        path = tuple(path)
        self.find(path)
        parent = self.find(path[:-1])
        if len(parent.parts) == 1 and len(path) > 1:
            return self.put(path[:-1], {} if parent.kind is dict else [])
        self._refuse_shared(path, whole=True)
        intended = copy.deepcopy(self.data)
        del value_at(intended, path[:-1])[path[-1]]
        return self.patched([self._without(path)], intended)

    def reword(self, changes: Iterable[Change]) -> str:
        """Return the text with words changed in keys and values.

        What stands behind an anchor changes for all its aliases.
        """
        patches: dict[int, Patch] = {}
        intended = copy.deepcopy(self.data)
        ordered = sorted(changes, key=lambda change: (change.is_key, -len(change.path)))
        for change in ordered:  # values before keys, and those from the inside out
            parent, last = value_at(intended, change.path[:-1]), change.path[-1]
            if change.is_key:
                node = self._key(change.path)
                word = change.pattern.sub(change.new, str(last))
                renamed = {word if key == last else key: each for key, each in parent.items()}
                parent.clear()
                parent.update(renamed)
            else:
                node = self.find(change.path)
                parent[last] = change.pattern.sub(change.new, parent[last])
            start = node.start + (len(node.anchor) + 1 if node.anchor else 0)
            written = self.text[start : node.end]
            patches[start] = Patch(start, node.end, change.pattern.sub(change.new, written))
        return self.patched(patches.values(), intended)

    def patched(self, patches: Iterable[Patch], intended: object) -> str:
        """Return the text with patches, if it then says what is intended, and nothing else.

        Raises
        ------
        GraphError
            If it would be no YAML, or say something else.
        """
        text = self.text
        ordered = sorted(patches, reverse=True)
        for start, end, new in ordered:
            text = text[:start] + new + text[end:]
        text = self._mark + text
        first = ordered[-1].start if ordered else 0
        try:
            data = read_yaml(text, self.file).plain()
        except GraphError as error:
            reason = error.problems[0].message
            raise self.error(first, f"this edit cannot be written here: {reason}") from error
        if repr(data) != repr(intended):  # types and the order of keys count
            message = "this edit cannot be written here: the file would say something else"
            raise self.error(first, message, "change the text by hand")
        return text

    def _read(self) -> TextNode:
        """Return the root of the tree."""
        opened: list[TextNode] = []
        anchors: dict[str, TextNode] = {}
        root: TextNode | None = None
        events: Iterator[Any] = iter(Parser(self.text).get_event, None)
        for event in events:
            end: int = event.end_mark.index
            if isinstance(event, yaml.CollectionEndEvent):
                node = opened.pop()
                last = node.parts[-1].end if node.parts else node.start
                node.end = end if node.is_flow else last
            elif isinstance(event, yaml.NodeEvent):
                node = self._node(event, anchors)
                outer = opened[-1] if opened else None
                if outer is None:
                    root = node
                elif outer.kind is dict and len(outer.keys) == len(outer.parts):
                    outer.keys.append(node)
                else:
                    outer.parts.append(node)
                if isinstance(event, yaml.CollectionStartEvent):
                    opened.append(node)
        return root or TextNode(0, 0, str)

    def _node(self, event: Any, anchors: dict[str, TextNode]) -> TextNode:
        start, end = event.start_mark.index, event.end_mark.index
        if isinstance(event, yaml.AliasEvent):
            return TextNode(start, end, str, alias=anchors[event.anchor or ""])
        if isinstance(event, yaml.ScalarEvent):
            if event.style in ("|", ">"):  # up to the last line's end
                end = start + len(self.text[start:end].rstrip("\r\n \t"))
            value = scalar(event.value) if event.implicit[0] else event.value
            node = TextNode(start, end, str, anchor=event.anchor or "", value=value)
        else:
            kind = dict if isinstance(event, yaml.MappingStartEvent) else list
            node = TextNode(start, end, kind, bool(event.flow_style), event.anchor or "")
        if node.anchor:
            anchors[node.anchor] = node
        return node

    def _along(self, path: Path) -> list[TextNode]:
        """Return the nodes along a path as they are written, from the root as far as there are."""
        nodes = [self._root]
        for key in path:
            outer = nodes[-1].target
            place = outer.place(key)
            if place is None:
                break
            nodes.append(outer.parts[place])
        return nodes

    def _written_at(self, path: Path) -> TextNode:
        """Return the node at a path, an alias as it stands there."""
        nodes = self._along(path)
        found = len(nodes) - 1
        if found < len(path):
            outer = nodes[-1].target
            where = ".".join(map(str, path[:found])) or "the graph"
            hint = nearest(path[found], [each.value for each in outer.keys])
            raise self.error(outer, f"{where} has no {quoted(path[found])}", hint)
        return nodes[-1]

    def _key(self, path: Path) -> TextNode:
        parent = self.find(path[:-1])
        place = parent.place(path[-1])
        assert place is not None
        return parent.keys[place]

    def _refuse_shared(self, path: Path, *, whole: bool) -> None:
        """Refuse to change what other places of the graph stand for, or stands for another.

        Parameters
        ----------
        path
        whole
            Whether all that is at the path goes, or something is added to it.
        """
        nodes = self._along(path)
        for node in nodes[1:]:
            if node.alias and not (whole and node is nodes[-1]):
                name, line = node.alias.anchor, self._place(node.alias.start).line
                message = f"*{name} stands for what is written in line {line}"
                raise self.error(node, message, "change it there, or write it out here")
        for node in (*nodes[1:], *(nodes[-1].walk() if whole else ())):
            again = [each.start for each in self._aliases if each.alias is node]
            if again:
                lines = ", ".join(str(self._place(start).line) for start in sorted(again))
                message = f"&{node.anchor} is used again in line {lines}"
                raise self.error(node, message, f"write it out there in place of *{node.anchor}")

    def _place(self, position: int) -> Place:
        lines = _BREAK.split(self.text[:position])
        return Place(self.file, len(lines), len(lines[-1]) + 1)

    def _line_end(self, position: int) -> int:
        match = _BREAK.search(self.text, position)
        return match.start() if match else len(self.text)

    def _column(self, position: int) -> int:
        """Return how many characters stand before a position in its line."""
        return self._place(position).column - 1

    def _is_in_flow(self, path: Path) -> bool:
        return any(node.target.is_flow for node in self._along(path)[: len(path)])

    def _replace(self, path: Path, value: object) -> list[Patch]:
        """Return the patches that give an existing key or item another value."""
        node, parent = self._written_at(path), self.find(path[:-1])
        if self._is_in_flow(path):
            lead = " " if node.start == node.end else ""
            return [Patch(node.start, node.end, lead + flow(value))]
        if parent.kind is dict:
            key = self._key(path)
            column, mark = self._column(key.start), self.text.index(":", key.end) + 1
        else:
            mark = self._dash(node) + 1
            column = self._column(mark - 1)
        head, body = _written(value, column, self._column(mark) + 1)
        lines = self._below(head, body, self._line_end(node.end))
        begins_below = bool(_BREAK.search(self.text, mark, node.start))
        if not body and not begins_below:
            lead = " " if node.start == node.end else ""
            return [Patch(node.start, node.end, lead + head)]
        end = self._line_end(mark)
        if begins_below:
            between = self.text[end : node.start]
            if between.strip():
                raise self.error(end, "a comment stands before what would be replaced")
            head = f" {head}" if head else ""
            return [Patch(mark, mark, head), Patch(end, node.end, lines)]
        end = self._line_end(node.end)
        head = f" {head}" if head else ""
        return [Patch(mark, node.end, head), Patch(end, end, lines)]

    def _insert(self, path: Path, value: object, after: object) -> list[Patch]:
        """Return the patches that add a key to a mapping, or an item to the end of a list."""
        parent = self.find(path[:-1])
        entry = f"{_scalar(path[-1], is_flow=True)}: " if parent.kind is dict else ""
        place = parent.place(after) if after is not None else None
        place = len(parent.parts) - 1 if place is None else place
        if self._is_in_flow((*path[:-1], "")):
            if not parent.parts:
                end = parent.end - 1
                return [Patch(end, end, entry + flow(value))]
            end = parent.parts[place].end
            return [Patch(end, end, f", {entry}{flow(value)}")]
        last = parent.parts[place]
        if parent.kind is dict:
            column, mark = self._column(parent.keys[0].start), f"{_scalar(path[-1], is_flow=True)}:"
        else:
            column, mark = self._column(self._dash(last)), "-"
        head, body = _written(value, column, column + len(mark) + 1)
        end = self._line_end(last.end)
        first = f"{' ' * column}{mark}{' ' if head else ''}{head}"
        return [Patch(end, end, self._below(head, [first, *body], end))]

    def _below(self, head: str, lines: Sequence[str], position: int) -> str:
        """Return lines as they stand below a position."""
        # breaks at the end of a text count, which the end of the file would hide
        counts = head in ("|", "|+") and position == len(self.text)
        return "".join(f"{self._newline}{line}" for line in lines) + self._newline * counts

    def _dash(self, item: TextNode) -> int:
        """Return the position of the dash before an item of a list."""
        return self.text.rindex("-", 0, item.start)

    def _without(self, path: Path) -> Patch:
        """Return the patch that removes one of several entries of a mapping or list."""
        parent = self.find(path[:-1])
        place = parent.place(path[-1])
        assert place is not None
        starts = [each.start for each in (parent.keys or parent.parts)]
        last = place == len(starts) - 1
        if self._is_in_flow(path):
            end = parent.parts[place].end
            patch = (
                Patch(parent.parts[place - 1].end, end, "")
                if last
                else Patch(starts[place], starts[place + 1], "")
            )
            gap = (patch.start, starts[place]) if last else (end, patch.end)
            self._refuse_comment(*gap)
            return patch
        start = starts[place] if parent.kind is dict else self._dash(parent.parts[place])
        end = self._line_end(parent.parts[place].end)
        column = self._column(start)
        before = self.text[start - column : start]
        if before.strip():  # the first entry, behind a dash
            self._refuse_comment(parent.parts[place].end, starts[place + 1])
            return Patch(start, starts[place + 1], "")
        if start == column:  # in the first line
            following = _BREAK.match(self.text, end)
            return Patch(0, following.end() if following else end, "")
        breaks = self.text[: start - column]
        above = len(breaks) - (2 if breaks.endswith("\r\n") else 1)
        return Patch(above, end, "")

    def _refuse_comment(self, start: int, end: int) -> None:
        if "#" in self.text[start:end]:
            raise self.error(start, "a comment stands behind what would be removed")


def value_at(data: Any, path: Path) -> Any:
    """Return what plain data have at a path; None where there is nothing."""
    for key in path:
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            return None
    return data


def _scalar(value: object, is_flow: bool) -> str:
    """Return a scalar as it is written in one line."""
    if isinstance(value, str):
        is_plain = (
            _PLAIN.fullmatch(value)
            and scalar(value) == value
            and isinstance(scalar(value), str)
            and not re.search(r": |:$| #|\s$|^\.\.\.$", value)
            and not (is_flow and ":" in value)
        )
        if is_plain:
            return value
        written = json.dumps(value, ensure_ascii=False)
        return _ESCAPED.sub(lambda match: f"\\u{ord(match[0]):04x}", written)
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if value != value else ".inf" if value > 0 else "-.inf"
    return repr(value)


def flow(value: object) -> str:
    """Return a value as it is written in one line, brackets around it."""
    if isinstance(value, Mapping):
        pairs = (f"{_scalar(key, is_flow=True)}: {flow(each)}" for key, each in value.items())
        return f"{{{', '.join(pairs)}}}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(flow, value))}]"
    return _scalar(value, is_flow=True)


def _written(value: object, column: int, start: int) -> tuple[str, list[str]]:
    """Return what is written behind a key in this column, and the lines below."""
    if isinstance(value, str) and "\n" in value and not _ESCAPED.search(value):
        lines = value.split("\n")
        if lines[0] and lines[0][0] not in " \t" and "\r" not in value:
            chomping = {0: "-", 1: ""}.get(len(value) - len(value.rstrip("\n")), "+")
            body = lines[:-1] if value.endswith("\n") else lines
            return f"|{chomping}", [f"{' ' * (column + 2)}{line}" if line else "" for line in body]
    line = flow(value) if isinstance(value, (Mapping, list, tuple)) else _scalar(value, False)
    if start + len(line) <= _WIDTH or not isinstance(value, (Mapping, list, tuple)):
        return line, []
    return "", list(_block(value, column + 2))


def _block(value: object, column: int) -> Iterator[str]:
    """Yield the lines of a mapping or list, each entry in a line of its own."""
    entries: Iterable[tuple[str, object]]
    if isinstance(value, Mapping):
        entries = ((f"{_scalar(key, is_flow=True)}:", each) for key, each in value.items())
    else:
        assert isinstance(value, (list, tuple))
        entries = (("-", each) for each in value)
    for mark, each in entries:
        head, body = _written(each, column, column + len(mark) + 1)
        yield f"{' ' * column}{mark}{' ' if head else ''}{head}"
        yield from body
