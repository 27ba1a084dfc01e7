"""Recordings as Vicon Nexus exports them to text: a file of sections, one of them trajectories.

A section begins with a line of its name and ends with an empty one; its lines are: the rate, the
names over the first of their columns, ``Frame,Sub Frame,X,Y,Z,...``, the units, the frames.
Source: files that the application wrote.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path

from nodegraph import quoted
from nodegraph_files.text.table import Row, Table, filled_width
from nodegraph_files.text.table_recording import rate_of_header, recording_of, warn_skipped
from nodegraph_files.units import AUTO, MILLIMETRES, LengthUnit, unit_from, unit_named
from nodegraph_mocap.recording import Trajectories

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
                f"{path}:{line}:{column}: the name {quoted(cell)} is out of place: names stand "
                "over X columns, every third from the third on"
            )
    return cells[LEADING::3]


def count_triples(path: Path, line: int, cells: Sequence[str], leading: int = LEADING) -> int:
    """Return the number of markers, after a look at the names X1, Y1, Z1, X2 ... of the columns.

    The cells of the columns that come first, `leading` of them, are empty; numbers after the
    letters may lack.

    Raises
    ------
    ValueError
        With file and line, and column where there is one, if a column is out of place.
    """
    last = filled_width(cells)
    for column, cell in enumerate(cells[:last], 1):
        place = column - 1 - leading
        wanted = f"{'XYZ'[place % 3]}{place // 3 + 1}" if place >= 0 else ""
        match = _COORDINATE.fullmatch(cell)
        if (match[1].upper() if match else cell) != wanted[:1]:
            raise ValueError(
                f"{path}:{line}:{column}: {quoted(cell)} where {wanted or 'an empty cell'} is "
                "expected"
            )
    if last <= leading or (last - leading) % 3:
        raise ValueError(
            f"{path}:{line}: {max(last - leading, 0)} columns X1, Y1, Z1, ... make no whole "
            "number of markers"
        )
    return (last - leading) // 3


_SECTIONS = ("Trajectories", "Model Outputs", "Devices", "Events", "Joints", "Segments")
_NAME = re.compile(rb'^"?(' + "|".join(_SECTIONS).encode() + rb')"?[,;\t ]*$', re.MULTILINE)
_EMPTY = re.compile(rb"\n[,;\t ]*(?=\n)")
_HEADER = 4  # rows after the section's name


def is_vicon(table: Table) -> bool:
    """Return whether the file begins with the name of a section."""
    return table.opening[0].cells[0] in _SECTIONS


def read_vicon(table: Table, *, zeros_missing: bool, unit: str, rate: float | None) -> Trajectories:
    """Read the section Trajectories; the others are left out.

    Warnings say which markers lacked a name or shared one, how many rows end early, and how many
    steps of frame numbers are not 1.

    Raises
    ------
    ValueError
        With file and line, and column where there is one: if the section, its rate or its frames
        lack, a name, column or unit is out of place, or a cell is not a number.
    """
    rows = _section(table)
    if len(rows) < _HEADER:
        raise ValueError(f"{table.path}: the section Trajectories ends within its header")
    rate_row, names, axes, units = rows
    used_rate = rate_of_header(rate, rate_row.cells[0], table.place(rate_row, 0), "the rate")
    labels = labels_over(table.path, names.line, names.cells)
    markers = count_triples(table.path, axes.line, ["", "", *axes.cells[LEADING:]])
    width = LEADING + 3 * markers
    body = _until_empty(table, units)
    wanted = [0, *range(LEADING, width)]
    cells = body.frames_below(units, width, wanted, lenient=True, counted=True)
    warn_skipped(axes.cells[0], cells[:, 0])
    return recording_of(
        cells[:, 1:],
        labels,
        rate=used_rate,
        unit=_unit(table, units, width, unit),
        zeros_missing=zeros_missing,
    )


def _section(table: Table) -> list[Row]:
    """Return the rows of the header of the section Trajectories."""
    there = list(_NAME.finditer(table.text.content))
    for match in there:
        if match[1] == b"Trajectories":
            line = table.text.content.count(b"\n", 0, match.end()) + 2
            return list(islice(table.rows(match.end() + 1, line), _HEADER))
    names = ", ".join(match[1].decode() for match in there)
    raise ValueError(f"{table.path}: no section Trajectories; there is {names}")


def _until_empty(table: Table, units: Row) -> Table:
    """Return the table up to the empty line that ends the section."""
    end = _EMPTY.search(table.text.content, units.end - 1)
    if end is None:
        return table
    text = replace(table.text, content=table.text.content[: end.start() + 1], plain=False)
    return replace(table, text=text)


def _unit(table: Table, units: Row, width: int, setting: str) -> LengthUnit:
    first, *_ = names = units.cells[LEADING:width]
    if setting == AUTO and (unit_named(first) is None or set(names) != {first}):
        wrong = next((place for place, unit in enumerate(names) if unit != first), 0)
        raise ValueError(
            f"{table.place(units, LEADING + wrong)}: unit {quoted(names[wrong])}, where one unit "
            f"of all columns is expected; there is {', '.join(MILLIMETRES)}"
        )
    return unit_from(setting, first)
