"""Recordings as OpenSim's tables of motion, files MOT and STO, where these hold points.

Lines ``key=value`` come first, to the line ``endheader``; then the names of the columns, ``time``
among them, and a row per frame. Points are cells ``x,y,z`` (``DataType=Vec3``) or three columns
each. Source: OpenSim documentation, "Motion (.mot) Files" and "Storage (.sto) Files".
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import islice
from pathlib import Path

from nodegraph import Format, listed, quoted
from nodegraph_files.text.table import Row, Table, check_distinct, filled_width
from nodegraph_files.text.table_recording import (
    known_rate,
    recording_of,
    warn_count,
    warn_irregular,
)
from nodegraph_files.text.text_file import read_text_file, start_in_utf8
from nodegraph_files.units import AUTO, unit_from
from nodegraph_mocap.recording import Trajectories

_END = "endheader"
_LONGEST_HEADER = 100  # lines
_AXES = "xyz"
_ENDINGS = (("_tx", "_ty", "_tz"), ("_x", "_y", "_z"), (".x", ".y", ".z"), ("_1", "_2", "_3"))
_ENDING = re.compile(r"[._]t?[xyz123]$", re.IGNORECASE)
_SCALAR, _POINT = ("", "double"), "vec3"


def read_mot(
    path: Path, *, zeros_missing: bool = True, unit: str = AUTO, rate: float | None = None
) -> Trajectories:
    """Read a recording from a MOT or STO file of points: locations of markers over time.

    Points are cells ``x,y,z``, or three columns each that end in ``_tx, _ty, _tz``, in
    ``_x, _y, _z``, in ``.x, .y, .z`` or in ``_1, _2, _3``. Warnings say where ``nRows`` is not the
    number of rows, and how many steps of time are irregular.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    unit
        Unit of length. By default what a line ``Units=mm`` of the header says; if there is none, m,
        as OpenSim has it, or cm or mm where that alone makes the points span 40 to 5000 mm, with a
        warning.
    rate
        Hz; by default that of the column ``time``.

    Returns
    -------
    Trajectories
        In millimetres.

    Raises
    ------
    ValueError
        With the file, and where there are any with line and column: if it is no such file, holds
        anything but points, such as angles of joints or forces, a cell is no number, a column is
        there twice, or there are no frames or no rate.
    """
    table = Table(read_text_file(path), {}, "\t", [], quoted=False)
    facts, end = _header(table)
    header = next(table.rows(end.end, end.line + 1), end)
    kind = facts.get("datatype", "").lower()
    if kind == _POINT:
        labels = _names(table, header)
        columns = ["time", *(f"{label}.{axis}" for label in labels for axis in _AXES)]
        content = table.text.content.replace(b",", b"\t")
        table = replace(table, text=replace(table.text, content=content, plain=False))
    elif kind in _SCALAR:
        names = _names(table, header)
        labels = _labels(table, header, names)
        columns = ["time", *names]
    else:
        raise ValueError(f"{path}: DataType={facts['datatype']}, but a recording is made of points")
    cells = table.frames_below(header, len(columns), range(len(columns)), names=columns)
    warn_count("rows", facts.get("nrows", str(len(cells))), len(cells))
    warn_irregular("time", cells[:, 0])
    return recording_of(
        cells[:, 1:],
        labels,
        rate=known_rate(table, cells[:, 0], rate),
        unit=unit_from(unit, facts.get("units", ""), assumed="m"),
        zeros_missing=zeros_missing,
    )


def _header(table: Table) -> tuple[dict[str, str], Row]:
    """Return the facts by name in small letters, and the row that ends them."""
    facts: dict[str, str] = {}
    for row in islice(table.rows(), _LONGEST_HEADER):
        text = " ".join(row.cells).strip()
        if text.lower() == _END:
            return facts, row
        key, _, value = text.partition("=")
        facts[key.strip().lower()] = value.strip()
    raise ValueError(f"{table.path}: no MOT or STO file: no line {_END} ends its header")


def _names(table: Table, header: Row) -> list[str]:
    """Return the names of the columns but the first, which holds times."""
    names = header.cells[: filled_width(header.cells)]
    place = f"{table.path}:{header.line}"
    if names[0].lower() != "time":
        raise ValueError(f"{place}: the first column is {quoted(names[0])}, where time is expected")
    if "" in names:
        raise ValueError(f"{place}:{names.index('') + 1}: a column has no name")
    if len(names) == 1:
        raise ValueError(f"{place}: no columns but time")
    check_distinct(names, place)
    return names[1:]


def _labels(table: Table, header: Row, names: list[str]) -> list[str]:
    """Return the points' names, of each of which three columns in a row hold the coordinates."""
    for endings in _ENDINGS:
        last = -len(endings[0])
        points = [name[:last] for name in names[::3]]
        written = [name[:last] + name[last:].lower() for name in names]
        if all(points) and written == [point + ending for point in points for ending in endings]:
            return points
    others = [name for name in names if not _ENDING.search(name)]
    raise ValueError(
        f"{table.path}:{header.line}: the columns are not the coordinates of points, three for "
        f"each, but perhaps angles or forces: {listed(others or names)}; OpenSim keeps markers in "
        "TRC files"
    )


FORMAT = Format(
    "OpenSim MOT",
    Trajectories,
    (".mot", ".sto"),
    read_mot,
    lambda start: b"\n" + _END.encode() in start_in_utf8(start),
)
