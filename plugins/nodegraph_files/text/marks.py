"""Marks, and masks, as a table of text: a row per span of a marker.

`nodegraph view` keeps what a person marks in such a table; `write.mask_csv` writes one whose marks
are all of the first kind.
"""

from __future__ import annotations

import csv
import re
from pathlib import Path

from nodegraph import Format, quoted
from nodegraph_files.text.table import text_lines
from nodegraph_files.text.text_file import start_in_utf8
from nodegraph_mocap.marks import Mark, Marks

_HEADS = (["marker", "start", "frames"], ["marker", "start", "frames", "mark", "other"])
_WHOLE = re.compile(r" *[0-9]{1,9} *")
_STARTS = re.compile(rb"marker,start,frames(,mark,other)?[\r\n]")


def read_marks_table(path: Path) -> Marks:
    """Read marks from a table with columns ``marker``, ``start``, ``frames``, ``mark``, ``other``.

    Without the last two, all samples are bad.

    Raises
    ------
    ValueError
        With file and line, if a row is not of that form.
    """
    rows = csv.reader(text_lines(path), strict=True)
    marks = []
    try:
        head = next(rows, [])
        if head not in _HEADS:
            raise ValueError(f"the columns must be {','.join(_HEADS[-1])}, not {_shown(head)}")
        for row in rows:
            if row:
                marks.append(_mark(row, len(head)))
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}:{max(rows.line_num, 1)}: {error}") from None
    return Marks(marks=tuple(marks))


def _mark(row: list[str], columns: int) -> Mark:
    if len(row) != columns:
        raise ValueError(f"{columns} cells are needed, not {_shown(row)}")
    marker, start, frames, *rest = row
    if not all(_WHOLE.fullmatch(cell) for cell in (start, frames)):
        raise ValueError(f"first frame and number of frames are needed, not {_shown(row)}")
    kind, other = rest or ("bad", "")
    return Mark(marker=marker, start=int(start), frames=int(frames), kind=kind, other=other)  # type: ignore[arg-type]


def _shown(row: list[str]) -> str:
    return quoted(",".join(row)) if row else "nothing"


FORMAT = Format(
    "table of marks",
    Marks,
    (".csv",),
    read_marks_table,
    lambda start: _STARTS.match(start_in_utf8(start)) is not None,
)
