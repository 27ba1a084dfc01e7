"""Recordings as Vicon Nexus exports them to text: a file of sections, one of them trajectories.

A section begins with a line of its name and ends with an empty one; its lines are: the rate, the
names over the first of their columns, ``Frame,Sub Frame,X,Y,Z,...``, the units, the frames.
Source: files that the application wrote.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import islice

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.text.frame_times import positive_number, tell_skipped
from nodegraph_mocap.text.named_triples import LEADING, count_triples, labels_over
from nodegraph_mocap.text.rows import filled, read_rows
from nodegraph_mocap.text.table_recording import recording_of
from nodegraph_mocap.text.table_text import Row, Table
from nodegraph_mocap.units import MILLIMETRES, millimetres_in

_SECTIONS = ("Trajectories", "Model Outputs", "Devices", "Events", "Joints", "Segments")
_NAME = re.compile(rb'^"?(' + "|".join(_SECTIONS).encode() + rb')"?[,;\t ]*$', re.MULTILINE)
_EMPTY = re.compile(rb"\n[,;\t ]*(?=\n)")
_HEADER = 4  # rows after the section's name


def is_vicon(table: Table) -> bool:
    """Return whether the file begins with the name of a section."""
    return table.opening[0].cells[0] in _SECTIONS


def read_vicon(table: Table, *, zeros_missing: bool) -> Trajectories:
    """Read the section Trajectories; the others are left out.

    Warnings tell which markers lacked a name or shared one, how many rows end early, and how many
    steps of frame numbers are not 1.

    Raises
    ------
    ValueError
        With file and line, and column where there is one: if the section, its rate or its frames
        lack, a name, column or unit is out of place, or a cell is no number.
    """
    rows = _section(table)
    if len(rows) < _HEADER:
        raise ValueError(f"{table.path}: the section Trajectories ends within its header")
    rate_row, names, axes, units = rows
    rate = positive_number(rate_row.cells[0])
    if rate is None:
        raise ValueError(
            f"{table.place(rate_row, 0)}: the rate {rate_row.cells[0]!r} is not a positive number"
        )
    labels = labels_over(table.path, names.line, names.cells)
    markers = count_triples(table.path, axes.line, ["", "", *axes.cells[LEADING:]])
    width = LEADING + 3 * markers
    body = _until_empty(table, units)
    below = body.below(units, width, [0, *range(LEADING, width)], lenient=True)
    cells = filled(read_rows(below))
    if not len(cells):
        raise ValueError(f"{table.path}: no frames follow line {units.line}")
    tell_skipped(axes.cells[0], cells[:, 0])
    return recording_of(
        cells[:, 1:],
        labels,
        rate=rate,
        millimetres=_millimetres(table, units, width),
        zeros_missing=zeros_missing,
    )


def _section(table: Table) -> list[Row]:
    """Return the rows of the header of the section Trajectories."""
    there = list(_NAME.finditer(table.text.content))
    for found in there:
        if found[1] == b"Trajectories":
            line = table.text.content.count(b"\n", 0, found.end()) + 2
            return list(islice(table.rows(found.end() + 1, line), _HEADER))
    names = ", ".join(found[1].decode() for found in there)
    raise ValueError(f"{table.path}: no section Trajectories; there is {names}")


def _until_empty(table: Table, units: Row) -> Table:
    """Return the table up to the empty line that ends the section."""
    end = _EMPTY.search(table.text.content, units.end - 1)
    if end is None:
        return table
    text = replace(table.text, content=table.text.content[: end.start() + 1], plain=False)
    return replace(table, text=text)


def _millimetres(table: Table, units: Row, width: int) -> float:
    first, *_ = said = units.cells[LEADING:width]
    factor = millimetres_in(first)
    if factor is None or set(said) != {first}:
        wrong = next((place for place, unit in enumerate(said) if unit != first), 0)
        raise ValueError(
            f"{table.place(units, LEADING + wrong)}: unit {said[wrong]!r}, where one unit of all "
            f"columns is expected; there is {', '.join(MILLIMETRES)}"
        )
    return factor
