"""Weights of blendshapes as a table of text: a column per shape, and one of times or a rate.

`write.weights_csv` writes such tables, and programs that use MediaPipe or ARKit do.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from nodegraph import Format, listed
from nodegraph_files.text.counters import is_counter
from nodegraph_files.text.table import check_distinct, filled_width, read_table
from nodegraph_files.text.table_recording import rate_of_counters
from nodegraph_files.text.text_file import start_in_utf8
from nodegraph_mocap.face_model import Weights

_STARTS = re.compile(rb"(?:#[^\n]*\n\s*)*\"?(?:time|frame)(?!code)", re.IGNORECASE)
_COORDINATE = re.compile(r".*[._: ][xyz]|[xyz]_?\d+", re.IGNORECASE)


def read_weights_table(path: Path, *, rate: float | None = None) -> Weights:
    """Read weights from a table with a column per shape, its name in the first row.

    An empty cell and ``NaN`` are missing. The rate (Hz), if it is not given, comes from a line
    ``# rate: 60`` or from a column ``time`` in seconds or ``timestamp``, as in `read_csv`; a
    warning counts irregular steps of times or frame numbers.

    Raises
    ------
    ValueError
        With the file, and where there are any with line and column: if a cell is no number or
        infinite, a column has no name or another's, columns hold coordinates, or there are no
        frames, no weights or no rate.
    """
    table = read_table(path)
    header = table.opening[0]
    names = header.cells[: filled_width(header.cells)]
    place = f"{path}:{header.line}"
    counters = [column for column, name in enumerate(names) if is_counter(name)]
    shapes = [column for column in range(len(names)) if column not in counters]
    coordinates = [names[column] for column in shapes if _COORDINATE.fullmatch(names[column])]
    if coordinates:
        raise ValueError(
            f"{place}: columns of coordinates, which read.recording reads, and not of weights: "
            f"{listed(coordinates)}"
        )
    if not shapes or "" in names:
        what = f"{names.index('') + 1}: a column has no name" if "" in names else " no weights"
        raise ValueError(f"{place}:{what}")
    check_distinct(names, place)
    cells = table.frames_below(header, len(names), range(len(names)), names=names)
    values = cells[:, shapes]
    infinite = np.argwhere(np.isinf(values))
    if len(infinite):
        frame, shape = infinite[0]
        raise ValueError(f"{path}: frame {frame}: the weight {names[shapes[shape]]} is infinite")
    return Weights(
        values=values,
        names=tuple(names[column] for column in shapes),
        rate=rate_of_counters(table, [(names[at], cells[:, at]) for at in counters], rate),
    )


FORMAT = Format(
    "table of weights",
    Weights,
    (".csv",),
    read_weights_table,
    lambda start: _STARTS.match(start_in_utf8(start).lstrip()) is not None,
)
