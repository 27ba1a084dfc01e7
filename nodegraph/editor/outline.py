"""What stands where in the text of a graph file, whether or not it is valid.

Keys and brackets are followed line by line, so that a text that is being written has one, too.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

Path = tuple[str, ...]
"""Keys from the outermost; an item of a list has the key ``-``."""

ITEM = "-"
_NODES = "nodes"
_KEY = re.compile(r"""(?:"([^"]*)"|'([^']*)'|([^\s#&*!|>%@{}\[\],"'][^:#{}\[\],]*?)) *:(?=\s|$)""")
_TOKEN = re.compile(
    r"""(?<!\S)\#.*|"(?:[^"\\]|\\.)*"?|'[^']*'?|[{}\[\],]|:(?=\s|$)|[^{}\[\],:"'\s]+|\s+|."""
)
_BEGIN = re.compile(" *(?:- +)*")
_SCALAR = re.compile(r":\s+[|>][-+0-9]*\s*(?:#.*)?$")


class Cursor(NamedTuple):
    """What is being written at a place.

    Attributes
    ----------
    path : Path
        The keys around it; of a value, its own key is the last.
    is_key : bool
        Whether a key may be written there.
    word : str
        What of it stands before the place.
    """

    path: Path
    is_key: bool
    word: str


class Span(NamedTuple):
    """The first and the last line of an entry, counted from 1."""

    first: int
    last: int


@dataclass(slots=True)
class _Frame:
    """An open mapping or list: of a block, the column of its key; of brackets, which they are."""

    key: str
    column: int = 0
    bracket: str = ""


@dataclass(slots=True)
class Outline:
    """The keys of a text with their lines, and what its entries use.

    Attributes
    ----------
    lines : dict of path to int
        The line of each key of a block, and of brackets.
    uses : dict of path to list of str
        The values of ``use``, by the paths of the mappings in which they stand, and the methods
        in lists of alternatives.
    count : int
        How many lines there are.
    """

    lines: dict[Path, int] = field(default_factory=dict)
    uses: dict[Path, list[str]] = field(default_factory=dict)
    count: int = 0

    def names(self, section: str) -> list[str]:
        """Return the keys of a section of the file."""
        return [path[1] for path in self.lines if len(path) == 2 and path[0] == section]

    def uses_below(self, path: Path) -> list[str]:
        """Return what the entry at a path uses, or its alternatives."""
        size = len(path)
        return [use for at, uses in self.uses.items() if at[:size] == path for use in uses]

    def nodes(self) -> dict[str, Span]:
        """Return the lines of each node."""
        starts = [
            (line, path) for path, line in self.lines.items() if len(path) == 1 or _is_node(path)
        ]
        return {
            path[1]: Span(line, max(line, following - 1))
            for (line, path), (following, _) in pairwise([*starts, (self.count + 1, ())])
            if _is_node(path)
        }


def _is_node(path: Path) -> bool:
    return len(path) == 2 and path[0] == _NODES


def outline_of(text: str) -> Outline:
    """Return the outline of a text."""
    return _Scan(text).outline


def cursor_in(text: str, position: int) -> Cursor:
    """Return what is being written at a position in a text."""
    return _Scan(text[:position]).cursor()


class _Scan:
    def __init__(self, text: str) -> None:
        self.outline = Outline()
        self._frames: list[_Frame] = []
        self._word = ""
        self._scalar_column = -1
        self._line = ""
        for number, line in enumerate(text.split("\n"), 1):
            self.outline.count = number
            self._read(line.rstrip("\r"), number)

    def cursor(self) -> Cursor:
        """Return what the end of the text is."""
        line, word = self._line, self._word.lstrip(" \"'")
        if line.lstrip().startswith("#") or " #" in line:
            return Cursor(("#",), False, "")
        if self._is_in_brackets():
            frame = self._frames[-1]
            is_key = frame.bracket == "{" and not frame.key
            return Cursor(self._path()[:-1] if is_key else self._path(), is_key, word)
        begin = _BEGIN.match(line)
        start = begin.end() if begin else 0
        if self._scalar_column >= 0 or _KEY.match(line, start):
            return Cursor(self._path(), False, word)
        self._close(start)
        return Cursor(self._path(), True, word)

    def _read(self, line: str, number: int) -> None:
        self._line, self._word = line, ""
        column = len(line) - len(line.lstrip(" "))
        if self._scalar_column >= 0 and (column > self._scalar_column or not line.strip()):
            return
        self._scalar_column = -1
        if self._is_in_brackets():
            self._scan(line, number)
            return
        if line[column : column + 1] in ("#", ""):
            return
        start = column
        while line[start : start + 2] == "- " or line[start:] == "-":
            self._close(start, is_item=True)
            self._frames.append(_Frame(ITEM, start))
            start += 1 + len(line[start + 1 :]) - len(line[start + 1 :].lstrip(" "))
        match = _KEY.match(line, start)
        if match:
            self._close(start)
            key = next((name for name in match.groups() if name is not None), "")
            self._frames.append(_Frame(key, start))
            self.outline.lines.setdefault(self._path(), number)
            start = match.end()
            if _SCALAR.search(line, match.end() - 1):
                self._scalar_column = column
                return
        self._scan(line[start:], number)

    def _scan(self, text: str, number: int) -> None:
        """Follow brackets and words of the rest of a line."""
        self._word = ""
        for token in _TOKEN.findall(text):
            if token[0] == "#":
                break
            self._take(token, number)
        word = self._word
        if not self._is_in_brackets():
            self._end_word()
        self._word = word

    def _take(self, token: str, number: int) -> None:
        frame = self._frames[-1] if self._frames else _Frame("")
        if token in ("{", "[") and (frame.bracket or not self._word.strip()):
            self._frames.append(_Frame("" if token == "{" else ITEM, 0, token))
            self._word = ""
        elif frame.bracket and token in ("}", "]"):
            self._end_word()
            self._frames.pop()
        elif frame.bracket and token == ",":
            self._end_word()
            frame.key = "" if frame.bracket == "{" else ITEM
        elif frame.bracket == "{" and token == ":" and not frame.key:
            frame.key = self._word.strip(" \"'")
            self.outline.lines.setdefault(self._path(), number)
            self._word = ""
        else:
            self._word += token

    def _end_word(self) -> None:
        word, self._word = self._word.strip(" \"'"), ""
        path = self._path()
        if not word or path[:1] != (_NODES,):
            return
        if path[-1] == "use":
            self.outline.uses.setdefault(path[:-1], []).append(word)
        elif "alternatives" in path[2:] and path[-1] in ("alternatives", ITEM):
            self.outline.uses.setdefault(path, []).append(word)

    def _is_in_brackets(self) -> bool:
        return bool(self._frames) and bool(self._frames[-1].bracket)

    def _close(self, column: int, *, is_item: bool = False) -> None:
        """Leave what does not go on in a line that begins in a column."""
        while self._frames and (
            self._frames[-1].column > column
            or (
                self._frames[-1].column == column and not (is_item and self._frames[-1].key != ITEM)
            )
        ):
            self._frames.pop()

    def _path(self) -> Path:
        return tuple(frame.key for frame in self._frames)
