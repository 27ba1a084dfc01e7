"""Tables whose markers' names stand over the first of three columns X, Y, Z, as in TRC files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from nodegraph_mocap.text.table_text import filled_width

LEADING = 2  # the columns that come first: frame number, and time or part of a frame
_COORDINATE = re.compile(r"([XYZ])\d*", re.IGNORECASE)


def labels_over(path: Path, line: int, cells: Sequence[str]) -> Sequence[str]:
    """Return the markers' names, which stand over every third column.

    Raises
    ------
    ValueError
        With file, line and column, if a name stands elsewhere.
    """
    for column, cell in enumerate(cells[LEADING:], LEADING + 1):
        if cell and (column - LEADING) % 3 != 1:
            raise ValueError(
                f"{path}:{line}:{column}: the name {cell!r} is out of place: names stand over X "
                "columns, every third from the third on"
            )
    return cells[LEADING::3]


def count_triples(path: Path, line: int, cells: Sequence[str]) -> int:
    """Return the number of markers, after a look at the names X1, Y1, Z1, X2 ... of the columns.

    The cells of the leading columns are empty; numbers after the letters may lack.

    Raises
    ------
    ValueError
        With file and line, and column where there is one, if a column is out of place.
    """
    last = filled_width(cells)
    for column, cell in enumerate(cells[:last], 1):
        place = column - 1 - LEADING
        wanted = f"{'XYZ'[place % 3]}{place // 3 + 1}" if place >= 0 else ""
        found = _COORDINATE.fullmatch(cell)
        if (found[1].upper() if found else cell) != wanted[:1]:
            raise ValueError(
                f"{path}:{line}:{column}: {cell!r} where {wanted or 'an empty cell'} is expected"
            )
    if last <= LEADING or (last - LEADING) % 3:
        raise ValueError(
            f"{path}:{line}: {max(last - LEADING, 0)} columns X1, Y1, Z1, ... make no whole "
            "number of markers"
        )
    return (last - LEADING) // 3
