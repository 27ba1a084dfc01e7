"""Lines and cells of tables of text, with the place of whatever is wrong in them."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

from nodegraph_mocap.text.text_file import read_text_file

SEPARATORS = ",;\t"
MISSING = ("", "nan", "NaN", "NAN", "Nan", "na", "NA", "Na", "null", "NULL", "Null")
_SMALL_MISSING = {word.lower() for word in MISSING}


def text_lines(path: Path) -> list[str]:
    """Return the lines of a text file, without what ends them.

    Raises
    ------
    ValueError
        If the file is no text in UTF-8, or in UTF-16 with a byte order mark.
    """
    text = read_text_file(path)
    try:
        return text.content.decode().split("\n")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a table of text: {error}") from None


def separator_of(line: str) -> str:
    """Return what separates the cells of a line: the most frequent of comma, semicolon and tab."""
    unquoted = re.sub(r'"[^"]*"', "", line)
    return max(SEPARATORS, key=unquoted.count)


def split_cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line, without quotes around them."""
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True))
    except csv.Error:
        return line.split(separator)  # what is wrong in it is told with its place


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
        Of the columns, where they have any, for the message.

    Raises
    ------
    ValueError
        With file, line and column, if a cell is no number.
    """
    try:
        if not any("_" in cell for cell in cells):
            return [float(cell or "nan") for cell in cells]
    except ValueError:
        pass  # one of them is special, or wrong
    said = [f" (column {name})" for name in names] or [""] * len(cells)
    return [
        _number(f"{path}:{line}:{column}", cell, where)
        for column, cell, where in zip(
            columns or range(1, len(cells) + 1), cells, said, strict=True
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
        raise ValueError(f"{place}: {plain[:40]!r} is not a number{where}") from None


def is_missing(cell: str) -> bool:
    """Return whether a cell says that there is no number: it is empty, or one of `MISSING`."""
    return cell.strip().lower() in _SMALL_MISSING
