"""Recordings as OptiTrack Motive exports them to text.

The first line is names and values in turn, among them the rate and the unit. Rows of types, names,
identifiers, parents and kinds of column follow, then ``Frame,Time (Seconds),X,Y,Z,...`` and the
frames. Source: OptiTrack, documentation of Motive, "Data Export: CSV".
"""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from nodegraph import quoted
from nodegraph_files.text.table import Row, Table
from nodegraph_files.text.table_recording import (
    rate_of_header,
    recording_of,
    stated_rate,
    warn_count,
    warn_other_rate,
    warn_skipped,
)
from nodegraph_files.units import AUTO, MILLIMETRES, LengthUnit, unit_from, unit_named
from nodegraph_mocap.recording import Trajectories

_FIRST = "Format Version"
_TYPES = {"marker", "rigid body", "rigid body marker", "bone", "bone marker", "marker constraint"}
_ROWS = 12  # more than any header has
_RATES = ("Export Frame Rate", "Capture Frame Rate")


@dataclass(frozen=True)
class _Header:
    """The text of each column in the rows above the frames; "" where there is none."""

    types: Sequence[str]
    names: Sequence[str]
    kinds: Sequence[str]
    axes: Row


def is_motive(table: Table) -> bool:
    """Return whether the file begins with the version of Motive's form."""
    return table.opening[0].cells[0] == _FIRST


def read_motive(
    table: Table, *, zeros_missing: bool, unit: str, rate: float | None
) -> Trajectories:
    """Read the measured markers, labelled and unlabelled.

    Rigid bodies, bones and the places where these expect their markers are left out, which a
    warning counts. Others say which markers lack a name or share one, how many rows end early,
    where the header's number of frames is wrong, and whether frame numbers or times contradict
    the rate. A file without a unit of length is taken to be in metres, Motive's own, unless its
    size is then no face's or body's.

    Raises
    ------
    ValueError
        With file and line, and column where there is one: if the rows of the header, the rate or
        all markers lack, the unit is unknown, or a cell is not a number.
    """
    used_rate = _rate(table, rate)
    length_unit = _unit(table, unit)
    header = _header(table)
    triples = _triples(table, header)
    columns = [column for first in triples for column in range(first, first + 3)]
    _warn_left_out(header, columns)
    names = [f"{name} {axis}" for name, axis in zip(header.names, header.axes.cells, strict=True)]
    width = len(header.axes.cells)
    wanted = [0, 1, *columns]
    cells = table.frames_below(header.axes, width, wanted, names=names, lenient=True, counted=True)
    warn_count("frames", _fact(table, "Total Exported Frames")[0] or str(len(cells)), len(cells))
    warn_skipped("the frame number", cells[:, 0])
    warn_other_rate(cells[:, 1], used_rate, "the header" if rate is None else "`rate`")
    return recording_of(
        cells[:, 2:],
        [header.names[first] for first in triples],
        rate=used_rate,
        unit=length_unit,
        zeros_missing=zeros_missing,
    )


def _fact(table: Table, name: str) -> tuple[str, str]:
    """Return what the first line says under a name, or "", and its place."""
    first = table.opening[0]
    if name not in first.cells[:-1]:
        return "", f"{table.path}:{first.line}"
    column = first.cells.index(name) + 1
    return first.cells[column], table.place(first, column)


def _rate(table: Table, setting: float | None) -> float:
    comment = stated_rate(table)
    name = next((name for name in _RATES if _fact(table, name)[0]), " or ".join(_RATES))
    written, place = _fact(table, name)
    return rate_of_header(setting, str(comment or written), place, name)


def _unit(table: Table, setting: str) -> LengthUnit:
    written, place = _fact(table, "Length Units")
    if setting == AUTO and written and unit_named(written) is None:
        raise ValueError(
            f"{place}: Length Units {quoted(written)}; there is {', '.join(MILLIMETRES)}"
        )
    return unit_from(setting, written, assumed="m")


def _header(table: Table) -> _Header:
    start = table.opening[0]
    above: list[Row] = []
    for row in table.rows(start.end, start.line + 1):
        if row.cells[0].lower() == "frame":
            return _header_below(table, above, row)
        above.append(row)
        if len(above) > _ROWS:
            break
    raise ValueError(f"{table.path}: no row 'Frame, Time (Seconds), X, Y, Z' follows the header")


def _header_below(table: Table, above: Sequence[Row], axes: Row) -> _Header:
    """Distinguish the rows by the word that begins them, or by what they hold."""
    rows: dict[str, Row] = {}
    for row in above:
        small = {cell.lower() for cell in row.cells[2:] if cell}
        word = "".join(row.cells[1:2]).lower()
        if word in ("type", "name", "id", "parent"):
            rows[word] = row
        elif small & {"position", "rotation"}:
            rows["kind"] = row
        elif small & _TYPES:
            rows["type"] = row
        else:
            rows.setdefault("name", row)
    if "name" not in rows:
        raise ValueError(f"{table.path}:{axes.line}: no row of names above the axes")
    types, names, kinds = (
        _as_wide(rows.get(word), len(axes.cells)) for word in ("type", "name", "kind")
    )
    return _Header(types, names, kinds, axes)


def _as_wide(row: Row | None, width: int) -> list[str]:
    cells = row.cells if row else []
    return [*cells[:width], *[""] * (width - len(cells))]


def _triples(table: Table, header: _Header) -> list[int]:
    """Return the first column of each measured marker."""
    rotated = {
        name for name, kind in zip(header.names, header.kinds, strict=True) if kind == "Rotation"
    }
    typed = any(kind.lower() in _TYPES for kind in header.types)
    axes = header.axes.cells
    columns = [
        column
        for column in range(2, len(axes))
        if axes[column] == "X"
        and header.kinds[column] in ("Position", "")
        and (header.types[column] == "Marker" if typed else header.names[column] not in rotated)
    ]
    for column in columns:
        if axes[column : column + 3] != ["X", "Y", "Z"]:
            raise ValueError(
                f"{table.place(header.axes, column)}: the columns of marker "
                f"{quoted(header.names[column])} are not X, Y, Z"
            )
    if not columns:
        there = sorted({kind for kind in header.types[2:] if kind})
        raise ValueError(
            f"{table.path}:{header.axes.line}: no columns of type Marker; there is "
            f"{', '.join(there) or 'no type'}"
        )
    return columns


def _warn_left_out(header: _Header, columns: Sequence[int]) -> None:
    used = {0, 1, *columns}
    other = Counter(
        header.types[column] or header.axes.cells[column] or "empty"
        for column in range(len(header.types))
        if column not in used
    )
    if other:
        counts = ", ".join(f"{count} of {kind}" for kind, count in other.items())
        warnings.warn(
            f"{other.total()} columns hold no measured marker and were left out: {counts}",
            stacklevel=3,
        )
