"""Rows of numbers in a text: read at once where that is safe, otherwise cell by cell.

The fast way is pandas, which rounds correctly; it is taken only where every row has as many cells
as the first. Whatever it cannot read is read again in plain steps, which know the place of each
cell: both give the same numbers.
"""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_mocap.text.cells import MISSING, cell_numbers, is_missing, split_cells
from nodegraph_mocap.text.text_file import Line, TextFile

if TYPE_CHECKING:
    from numpy.typing import NDArray

_WIDEST = 5_000  # columns; each costs pandas a millisecond or so
_PIECE = 1 << 24  # bytes
_COMMA = re.compile(r"[+-]?\d*,\d*(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")


@dataclass(frozen=True, kw_only=True)
class Rows:
    """Where the numbers of a table stand.

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
        Of all columns, for messages; or none.
    lenient : bool
        Whether a row may end early, and may have empty cells beyond the last column.
    """

    text: TextFile
    start: int
    line: int
    separator: str
    width: int
    wanted: Sequence[int]
    names: Sequence[str] = ()
    lenient: bool = False

    def lines(self) -> Iterator[Line]:
        """Return the lines that are not blank; tabs are no blanks where they separate cells."""
        blanks = " " if self.separator == "\t" else None
        return (line for line in self.text.lines(self.start, self.line) if line.text.strip(blanks))


def read_rows(rows: Rows) -> NDArray[np.float64]:
    """Return the numbers of the wanted columns, a row per line; missing ones are NaN.

    Warnings tell how many rows end early, and that commas count as decimal points.

    Raises
    ------
    ValueError
        With file and line, and column where there is one: if a cell is no number, a row has too
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
    kept = len(rows.wanted)
    return numbers[:, :kept] if np.isnan(numbers[:, kept:]).all() else None


def _is_special(rows: Rows) -> bool:
    """Return whether there are comments or decimal commas among the rows."""
    special = "#" * rows.text.commented + "," * (rows.separator != ",")
    return any(rows.text.content.find(one.encode(), rows.start) >= 0 for one in special)


def _parsed(rows: Rows, columns: list[int] | None) -> NDArray[np.float64] | None:
    import pandas
    from packaging.version import Version

    # From 3.1 on, pandas rounds correctly anyway, and warns where it is asked to.
    asked = Version(pandas.__version__) < Version("3.1")
    exact: dict[str, Any] = {"float_precision": "round_trip"} if asked else {}
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
        chosen = [cells[column] for column in rows.wanted]
        numbers[row] = cell_numbers(rows.text.path, line, chosen, columns=columns, names=names)
    return numbers


def _make_wide(rows: Rows, table: list[tuple[int, list[str]]]) -> None:
    """Give every row as many cells as there are columns, where it may have fewer or more."""
    early = []
    for line, cells in table:
        if len(cells) == rows.width:
            continue
        if not rows.lenient or not all(map(is_missing, cells[rows.width :])):
            raise ValueError(
                f"{rows.text.path}:{line}: {len(cells)} cells, but {rows.width} columns have names"
            )
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


def _commas_are_points(rows: Rows, table: list[tuple[int, list[str]]]) -> bool:
    """Return whether commas in cells separate decimals, which a warning tells.

    Raises
    ------
    ValueError
        If there are dots as well, or every comma may separate thousands.
    """
    found = [
        (f"{rows.text.path}:{line}:{column + 1}", cells[column].strip())
        for line, cells in table
        for column in rows.wanted
        if "," in cells[column]
    ]
    if not found:
        return False
    _check_commas(rows, table, found)
    warnings.warn(
        f"commas count as decimal points, in {len(found)} cells; the first is {found[0][1]!r}",
        stacklevel=5,
    )
    return True


def _check_commas(
    rows: Rows, table: list[tuple[int, list[str]]], found: list[tuple[str, str]]
) -> None:
    for place, cell in found:
        if not _COMMA.fullmatch(cell):
            raise ValueError(f"{place}: {cell[:40]!r} is not a number")
    for line, cells in table:
        for column in rows.wanted:
            if "." in cells[column]:
                raise ValueError(
                    f"{rows.text.path}:{line}:{column + 1}: {cells[column]!r} has a dot, but "
                    f"{found[0][1]!r} ({found[0][0]}) a comma: only one can separate decimals"
                )
    if all(_THOUSANDS.fullmatch(cell) for _, cell in found):
        raise ValueError(
            f"{found[0][0]}: {found[0][1]!r} may be {found[0][1].replace(',', '.')} or "
            f"{found[0][1].replace(',', '')}: write decimals after a dot, and thousands without "
            "a separator"
        )
