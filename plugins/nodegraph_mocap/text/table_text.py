"""A table of text before its form is known: its comments, its separator and its first rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from nodegraph_mocap.text.cells import SEPARATORS, separator_of, split_cells
from nodegraph_mocap.text.rows import Rows
from nodegraph_mocap.text.text_file import Comment, TextFile, read_text_file

_OPENING = 6  # rows, which no header of names exceeds


class Row(NamedTuple):
    """A line as cells without blanks around them: its number, its first byte, the next one's."""

    line: int
    cells: list[str]
    start: int
    end: int


@dataclass(frozen=True)
class Table:
    """A table of text as it was written.

    Attributes
    ----------
    text : TextFile
    comments : dict
        What lines ``# name: value`` say, by name.
    separator : str
        What separates cells in the first line that has any separator.
    opening : list of Row
        The first rows that are not empty.
    quoted : bool
        Whether quotes keep a separator within a cell.
    """

    text: TextFile
    comments: dict[str, Comment]
    separator: str
    opening: list[Row]
    quoted: bool = True

    @property
    def path(self) -> Path:
        """The file."""
        return self.text.path

    def rows(self, start: int = 0, line: int = 1) -> Iterator[Row]:
        """Return the rows in which a cell is not empty, from a byte on."""
        return _rows(self.text, self.separator, start, line, quoted=self.quoted)

    def place(self, row: Row, column: int) -> str:
        """Return file, line and column, which is counted from 0."""
        return f"{self.path}:{row.line}:{column + 1}"

    def below(
        self,
        row: Row,
        width: int,
        wanted: Sequence[int],
        *,
        names: Sequence[str] = (),
        lenient: bool = False,
    ) -> Rows:
        """Return the rows that follow a row of the header; see `Rows`.

        Where they may end early, empty rows right below the header are no frames.
        """
        first = next(self.rows(row.end, row.line + 1), None) if lenient else None
        return Rows(
            text=self.text,
            start=first.start if first else row.end,
            line=first.line if first else row.line + 1,
            separator=self.separator,
            width=width,
            wanted=wanted,
            names=names,
            lenient=lenient,
        )


def read_table(path: Path) -> Table:
    """Read a text file as a table.

    Raises
    ------
    ValueError
        If it is no text, or has no line.
    """
    text = replace(read_text_file(path), commented=True)
    first = [
        line.text for line in islice((one for one in text.lines() if one.text.strip()), _OPENING)
    ]
    separated = next((line for line in first if set(line) & set(SEPARATORS)), "")
    separator = separator_of(separated)
    opening = list(islice(_rows(text, separator, 0, 1, quoted=True), _OPENING))
    if not opening:
        raise ValueError(f"{path}: no frames: the file is empty or holds only comments")
    return Table(text, text.comments(), separator, opening)


def _rows(text: TextFile, separator: str, start: int, line: int, *, quoted: bool) -> Iterator[Row]:
    for found in text.lines(start, line):
        split = split_cells(found.text, separator) if quoted else found.text.split(separator)
        cells = [cell.strip() for cell in split]
        if any(cells):
            yield Row(found.number, cells, found.start, found.end)


def filled_width(cells: Sequence[str]) -> int:
    """Return the number of cells up to the last that is not empty."""
    return max((index for index, cell in enumerate(cells, 1) if cell), default=0)
