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


def cell_numbers(
    path: Path, line: int, cells: Sequence[str], *, first: int = 1, names: Sequence[str] = ()
) -> list[float]:
    """Return the numbers of a line's cells; an empty cell, or one that says NaN, is NaN.

    Parameters
    ----------
    path, line
        Where the cells stand.
    cells
        As they are written.
    first
        Number of the first one's column, counted from 1.
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
        for column, (cell, where) in enumerate(zip(cells, said, strict=True), first)
    ]


def _number(place: str, cell: str, where: str) -> float:
    plain = cell.strip()
    if plain.lower() in _MISSING:
        return float("nan")
    try:
        # Python reads 1_000 as a number; a table does not mean one.
        return float(plain.replace("_", "?"))
    except ValueError:
        raise ValueError(f"{place}: {plain!r} is not a number{where}") from None
