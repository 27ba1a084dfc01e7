"""A table of text before its form is known: its comments, its separator and its first rows."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from nodegraph import listed, quoted
from nodegraph_files.text.text_file import Comment, Line, TextFile, read_text_file
from nodegraph_mocap.checks import distinct

if TYPE_CHECKING:
    from numpy.typing import NDArray


SEPARATORS = ",;\t"
_QUOTED = re.compile(r'"[^"]*"')
MISSING = ("", "nan", "NaN", "NAN", "Nan", "na", "NA", "Na", "null", "NULL", "Null")
_SMALL_MISSING = {word.lower() for word in MISSING}


def text_lines(path: Path) -> list[str]:
    """Return the lines of a text file, without what ends them.

    Raises
    ------
    ValueError
        With file and line, if it is not text in UTF-8, or in UTF-16 with a byte order mark.
    """
    return [line.text for line in read_text_file(path).lines()]


def without_cut_row(text: TextFile, start: int, separator: str, width: int) -> TextFile:
    """Return the text without its last row, with a warning, if the file ends within it.

    Parameters
    ----------
    text
    start
        Byte at which the first row starts; it is never left out.
    separator
    width
        Number of cells of a row.
    """
    last = text.content.rfind(b"\n") + 1
    if not start < last < len(text.content):
        return text
    line = next(text.lines(last, text.content.count(b"\n") + 1))
    cells = len(split_cells(line.text, separator))
    if not line.text.strip() or cells >= width:
        return text
    warnings.warn(
        f"the file ends within line {line.number}, after {cells} of {width} cells; this line was "
        "left out",
        stacklevel=5,
    )
    return replace(text, content=text.content[:last], plain=False)


def separator_of(line: str) -> str:
    """Return what separates the cells of a line: the most frequent of comma, semicolon and tab."""
    unquoted = _QUOTED.sub("", line)
    return max(SEPARATORS, key=unquoted.count)


def split_cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line, without quotes around them."""
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error:
        return line.split(separator)  # the error is reported later, with its place


def cell_numbers(
    path: Path,
    line: int,
    cells: Sequence[str],
    *,
    columns: Sequence[int] = (),
    names: Sequence[str] = (),
) -> list[float]:
    """Return the numbers of a line's cells; an empty cell, or one that says NaN, is NaN.

    Parameters
    ----------
    path, line
        Where the cells stand.
    cells
        As they are written.
    columns
        Number of each one's column, counted from 1; by default they begin with the first.
    names
        Names of the columns, where they have any, for the message.

    Raises
    ------
    ValueError
        With file, line and column, if a cell is not a number.
    """
    try:
        if not any("_" in cell for cell in cells):
            return [float(cell or "nan") for cell in cells]
    except ValueError:
        pass  # one of them is special, or wrong
    suffixes = [f" (column {listed([name])})" for name in names] or [""] * len(cells)
    return [
        _number(f"{path}:{line}:{column}", cell, where)
        for column, cell, where in zip(
            columns or range(1, len(cells) + 1), cells, suffixes, strict=True
        )
    ]


def _number(place: str, cell: str, where: str) -> float:
    plain = cell.strip()
    if is_missing(plain):
        return float("nan")
    try:
        # Python reads 1_000 as a number; a table does not mean one.
        return float(plain.replace("_", "?"))
    except ValueError:
        raise ValueError(f"{place}: {quoted(plain)} is not a number{where}") from None


def is_missing(cell: str) -> bool:
    """Return whether a cell says that there is no number: it is empty, or one of `MISSING`."""
    return cell.strip().lower() in _SMALL_MISSING


_WIDEST = 5_000  # columns; each costs pandas a millisecond or so
_PIECE = 1 << 24  # bytes
_COMMA = re.compile(r"[+-]?\d*,\d*(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")


@dataclass(frozen=True, kw_only=True)
class Rows:
    """The place of a table's numbers in its file.

    Attributes
    ----------
    text : TextFile
    start : int
        The first byte of the first row.
    line : int
        The number of its line.
    separator : str
    width : int
        Number of columns.
    wanted : sequence of int
        The columns to read, counted from 0 and rising; the others may hold anything.
    names : sequence of str
        Names of all columns, for messages; or none.
    lenient : bool
        Whether a row may end early, and may have empty cells beyond the last column.
    beyond : int
        Rows may have more cells than columns, which are left out: up to as many as the first row
        has, or a multiple of this number.
    """

    text: TextFile
    start: int
    line: int
    separator: str
    width: int
    wanted: Sequence[int]
    names: Sequence[str] = ()
    lenient: bool = False
    beyond: int = 0

    def lines(self) -> Iterator[Line]:
        """Return the lines that are not blank; tabs are not blanks where they separate cells."""
        blanks = " " if self.separator == "\t" else None
        return (line for line in self.text.lines(self.start, self.line) if line.text.strip(blanks))


def read_rows(rows: Rows) -> NDArray[np.float64]:
    """Return the numbers of the wanted columns, a row per line; missing ones are NaN.

    Warnings say how many rows end early, how many columns without names were left out, and that
    commas count as decimal points.

    Raises
    ------
    ValueError
        With file and line, and column where there is one: if a cell is not a number, a row has too
        few cells or too many, or a comma may separate decimals or thousands.
    """
    numbers = _at_once(rows)
    return _cell_by_cell(rows) if numbers is None else numbers


def filled(numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rows that are not wholly missing, where the first column counts frames."""
    lost = np.isnan(numbers[:, 0])
    if lost.any():
        return numbers[~(lost & np.isnan(numbers).all(axis=1))]
    return numbers


def _at_once(rows: Rows) -> NDArray[np.float64] | None:
    """Return what pandas reads, or None if a row or a cell is not as it should be."""
    first = next(rows.lines(), None)
    if first is None or rows.width > _WIDEST or _is_special(rows):
        return None
    width = first.text.count(rows.separator) + 1
    if width < rows.width or (width > rows.width and not rows.lenient):
        return None
    columns = [*rows.wanted, *range(rows.width, width)]
    numbers = _parsed(rows, None if len(columns) == width else columns)
    if numbers is None or not _all_as_wide(rows, width, numbers):
        return None
    count = len(rows.wanted)
    row, column = (~np.isnan(numbers[:, count:])).nonzero()
    beyond = dict(zip(row.tolist(), (column + 1).tolist(), strict=True)).values()
    at_first = max((column[row == 0] + 1).tolist(), default=0)
    if not all(_may_follow(rows, cells, at_first) for cells in beyond):
        return None
    _warn_beyond(rows, beyond)
    return numbers[:, :count]


def _is_special(rows: Rows) -> bool:
    """Return whether there are comments or decimal commas among the rows."""
    special = "#" * rows.text.commented + "," * (rows.separator != ",")
    return any(rows.text.content.find(word.encode(), rows.start) >= 0 for word in special)


def _parsed(rows: Rows, columns: list[int] | None) -> NDArray[np.float64] | None:
    import pandas
    from packaging.version import Version

    # From 3.1 on, pandas rounds correctly anyway, and warns about the option.
    is_old = Version(pandas.__version__) < Version("3.1")
    exact: dict[str, Any] = {"float_precision": "round_trip"} if is_old else {}
    stream = BytesIO(rows.text.content)
    stream.seek(rows.start)
    # Pandas reads a file, but no stream, in several threads.
    source = (rows.text.path, rows.line - 1) if rows.text.plain else (stream, 0)
    try:
        # Without `dtype`, which takes a quarter longer; the types that come out are looked at.
        frame = pandas.read_csv(
            source[0],
            skiprows=source[1],
            sep=rows.separator,
            header=None,
            usecols=columns,
            keep_default_na=False,
            na_values=list(MISSING),
            quoting=csv.QUOTE_NONE,  # else a lone quote above would hide the rows
            compression=None,
            low_memory=False,  # else columns of mixed types are warned of before we can say where
            **exact,
        )
    except ValueError:
        return None
    if not {kind.kind for kind in frame.dtypes} <= set("iuf"):
        return None
    return np.asarray(frame.to_numpy(), dtype=np.float64)


def _all_as_wide(rows: Rows, width: int, numbers: NDArray[np.float64]) -> bool:
    """Return whether every row has as many cells as the first.

    Pandas fills rows that end early without a word, and takes rows that are too long where it
    reads only some of the columns.
    """
    if numbers.shape[1] < width:
        return all(line.text.count(rows.separator) == width - 1 for line in rows.lines())
    if not np.isnan(numbers[:, -1]).any():
        return True
    content = np.frombuffer(rows.text.content, dtype=np.uint8)
    separators = sum(
        int(np.count_nonzero(content[start : start + _PIECE] == ord(rows.separator)))
        for start in range(rows.start, len(content), _PIECE)
    )
    return separators == len(numbers) * (width - 1)


def _cell_by_cell(rows: Rows) -> NDArray[np.float64]:
    table = [(line.number, split_cells(line.text, rows.separator)) for line in rows.lines()]
    _make_wide(rows, table)
    if _commas_are_points(rows, table):
        table = [(line, [cell.replace(",", ".") for cell in cells]) for line, cells in table]
    columns = [column + 1 for column in rows.wanted]
    names = [rows.names[column] for column in rows.wanted] if rows.names else ()
    numbers = np.empty((len(table), len(columns)))
    for row, (line, cells) in enumerate(table):
        wanted = [cells[column] for column in rows.wanted]
        numbers[row] = cell_numbers(rows.text.path, line, wanted, columns=columns, names=names)
    return numbers


def _make_wide(rows: Rows, table: list[tuple[int, list[str]]]) -> None:
    """Give every row as many cells as there are columns, where it may have fewer or more."""
    early, beyond = [], []
    first = _known_width(table[0][1]) - rows.width if table else 0
    for line, cells in table:
        if len(cells) == rows.width:
            continue
        there = _known_width(cells) if rows.lenient else len(cells)
        more = max(there - rows.width, 0)
        if not (rows.lenient and _may_follow(rows, more, first)):
            raise ValueError(
                f"{rows.text.path}:{line}: {there} cells, but {rows.width} columns have names"
            )
        if more:
            beyond.append(more)
        if len(cells) < rows.width:
            early.append(line)
            if line == table[-1][0] and not rows.text.content.endswith(b"\n"):
                cells[-1] = ""  # the file ends within this row: its last number may lack digits
        cells[:] = cells[: rows.width] + [""] * (rows.width - len(cells))
    if early:
        warnings.warn(
            f"{len(early)} rows end before the last of {rows.width} columns; what they lack counts "
            f"as missing; the first is line {early[0]}",
            stacklevel=5,
        )
    _warn_beyond(rows, beyond)


def _known_width(cells: Sequence[str]) -> int:
    """Return the number of cells up to the last that is not missing."""
    return max((index for index, cell in enumerate(cells, 1) if not is_missing(cell)), default=0)


def _may_follow(rows: Rows, cells: int, first: int) -> bool:
    """Return whether so many cells may follow the columns, as so many do in the first row."""
    return cells == 0 or (rows.beyond > 0 and (cells <= first or cells % rows.beyond == 0))


def _warn_beyond(rows: Rows, beyond: Collection[int]) -> None:
    """Warn of cells that were left out, given how many of each row that has any."""
    if beyond:
        warnings.warn(
            f"{max(beyond)} columns follow the {rows.width} that have names, with numbers in "
            f"{len(beyond)} rows, and were left out",
            stacklevel=6,
        )


def _commas_are_points(rows: Rows, table: list[tuple[int, list[str]]]) -> bool:
    """Return whether commas in cells separate decimals, and warn if they do.

    Raises
    ------
    ValueError
        If there are dots as well, or every comma may separate thousands.
    """
    commas = [
        (f"{rows.text.path}:{line}:{column + 1}", cells[column].strip())
        for line, cells in table
        for column in rows.wanted
        if "," in cells[column]
    ]
    if not commas:
        return False
    _check_commas(rows, table, commas)
    warnings.warn(
        f"commas count as decimal points, in {len(commas)} cells; the first is "
        f"{quoted(commas[0][1])}",
        stacklevel=5,
    )
    return True


def _check_commas(
    rows: Rows, table: list[tuple[int, list[str]]], commas: list[tuple[str, str]]
) -> None:
    for place, cell in commas:
        if not _COMMA.fullmatch(cell):
            raise ValueError(f"{place}: {quoted(cell)} is not a number")
    for line, cells in table:
        for column in rows.wanted:
            if "." in cells[column]:
                raise ValueError(
                    f"{rows.text.path}:{line}:{column + 1}: {quoted(cells[column])} has a dot, but "
                    f"{quoted(commas[0][1])} ({commas[0][0]}) a comma: only one can separate "
                    "decimals"
                )
    if all(_THOUSANDS.fullmatch(cell) for _, cell in commas):
        raise ValueError(
            f"{commas[0][0]}: {quoted(commas[0][1])} may be {commas[0][1].replace(',', '.')} or "
            f"{commas[0][1].replace(',', '')}: write decimals after a dot, and thousands without "
            "a separator"
        )


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
        Values of lines ``# name: value``, by name.
    separator : str
        The separator of cells in the first line that has any.
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
        beyond: int = 0,
    ) -> Rows:
        """Return the rows that follow a row of the header; see `Rows`.

        Where they may end early, empty rows right below the header are not frames; elsewhere the
        last is left out, with a warning, if the file ends within it.
        """
        first = next(self.rows(row.end, row.line + 1), None) if lenient else None
        text = self.text if lenient else without_cut_row(self.text, row.end, self.separator, width)
        return Rows(
            text=text,
            start=first.start if first else row.end,
            line=first.line if first else row.line + 1,
            separator=self.separator,
            width=width,
            wanted=wanted,
            names=names,
            lenient=lenient,
            beyond=beyond,
        )

    def frames_below(
        self,
        row: Row,
        width: int,
        wanted: Sequence[int],
        *,
        names: Sequence[str] = (),
        lenient: bool = False,
        counted: bool = False,
    ) -> NDArray[np.float64]:
        """Return the numbers that follow a row of the header, a row per frame; see `read_rows`.

        Where the first of the columns counts frames, a row that is wholly missing is none.

        Raises
        ------
        ValueError
            If there are no frames, or as `read_rows` does.
        """
        numbers = read_rows(self.below(row, width, wanted, names=names, lenient=lenient))
        if counted:
            numbers = filled(numbers)
        if not len(numbers):
            raise ValueError(f"{self.path}: no frames follow line {row.line}")
        return numbers


def read_table(path: Path) -> Table:
    """Read a text file as a table.

    Raises
    ------
    ValueError
        If it is not text, or has no line.
    """
    text = replace(read_text_file(path), commented=True)
    first = [
        line.text for line in islice((line for line in text.lines() if line.text.strip()), _OPENING)
    ]
    separated = next((line for line in first if set(line) & set(SEPARATORS)), "")
    separator = separator_of(separated)
    opening = list(islice(_rows(text, separator, 0, 1, quoted=True), _OPENING))
    if not opening:
        raise ValueError(f"{path}: no frames: the file is empty or holds only comments")
    return Table(text, text.comments(), separator, opening)


def _rows(text: TextFile, separator: str, start: int, line: int, *, quoted: bool) -> Iterator[Row]:
    for source in text.lines(start, line):
        split = split_cells(source.text, separator) if quoted else source.text.split(separator)
        cells = [cell.strip() for cell in split]
        if any(cells):
            yield Row(source.number, cells, source.start, source.end)


def filled_width(cells: Sequence[str]) -> int:
    """Return the number of cells up to the last that is not empty."""
    return max((index for index, cell in enumerate(cells, 1) if cell), default=0)


def check_distinct(names: Sequence[str], place: str) -> None:
    """Raise `ValueError` with the place of the header if two columns have one name."""
    try:
        distinct("columns", names)
    except ValueError as error:
        raise ValueError(f"{place}: {error}") from None
