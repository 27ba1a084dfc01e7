"""Lines and numbers of files that are text, with the place of whatever is wrong in them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

_MISSING = {"", "nan", "na", "null"}


def text_lines(path: Path) -> list[str]:
    """Return the lines of a text file, without what ends them.

    Raises
    ------
    ValueError
        If the file is no text in UTF-8.
    """
    try:
        return path.read_text(encoding="utf-8-sig").split("\n")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a table of text: {error}") from None


def cell_numbers(path: Path, line: int, cells: Sequence[str], *, first: int = 1) -> list[float]:
    """Return the numbers of a line's cells; an empty cell, or one that says NaN, is NaN.

    Parameters
    ----------
    path, line
        Where the cells stand.
    cells
        As they are written.
    first
        Number of the first one's column, counted from 1.

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
    return [_number(path, line, column, cell) for column, cell in enumerate(cells, first)]


def _number(path: Path, line: int, column: int, cell: str) -> float:
    plain = cell.strip()
    if plain.lower() in _MISSING:
        return float("nan")
    try:
        # Python reads 1_000 as a number; a table does not mean one.
        return float(plain.replace("_", "?"))
    except ValueError:
        raise ValueError(f"{path}:{line}:{column}: {plain!r} is not a number") from None
