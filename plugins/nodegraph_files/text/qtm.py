"""Recordings as Qualisys Track Manager exports them to text: facts line by line, then frames.

Each line of the header is a name in capitals and its value; MARKER_NAMES is the last of them, or
TRAJECTORY_TYPES, which may follow it. A line of column names may come next, and each frame may
begin with its number and time. Lengths are in millimetres. Source: Qualisys, documentation of
QTM, "Motion data (.tsv)".
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence

from nodegraph import quoted
from nodegraph_files.text.table import Row, Table, filled_width
from nodegraph_files.text.table_recording import (
    is_number,
    rate_of_header,
    recording_of,
    stated_rate,
    warn_count,
    warn_other_rate,
    warn_skipped,
)
from nodegraph_files.units import unit_from
from nodegraph_mocap.recording import Trajectories

_FIRST = {"FILE_VERSION", "NO_OF_FRAMES", "NO_OF_CAMERAS", "NO_OF_MARKERS", "FREQUENCY"}
_FACT = re.compile(r"[A-Z][A-Z0-9_]*")
_LEADING = 2  # frame number and time, where a row begins with them


def is_qtm(table: Table) -> bool:
    """Return whether the file begins with a fact of a QTM header."""
    return table.opening[0].cells[0] in _FIRST


def read_qtm(table: Table, *, zeros_missing: bool, unit: str, rate: float | None) -> Trajectories:
    """Read a recording of three-dimensional data.

    What stands in the rows counts, not the numbers of the header. Warnings say where the two
    differ, which markers lack a name or share one, which trajectories are not wholly measured,
    how many rows end early, and whether frame numbers or times contradict the frequency.

    Raises
    ------
    ValueError
        With file and line, and column where there is one: if the data are not 3D, there are no
        markers, no rate or no frames, the columns make no whole number of markers, or a cell is
        no number.
    """
    facts, header = _header(table)
    _check_kind(table, facts)
    used_rate = _rate(table, facts, rate)
    labels = facts["MARKER_NAMES"].cells[1 : filled_width(facts["MARKER_NAMES"].cells)]
    leading, width = _shape(table, header, len(labels))
    cells = table.frames_below(header, width, range(width), lenient=True, counted=leading > 0)
    _warn_facts(facts, len(cells), (width - leading) // 3)
    if leading:
        warn_skipped("the frame number", cells[:, 0])
        warn_other_rate(cells[:, 1], used_rate, "FREQUENCY" if rate is None else "`rate`")
    return recording_of(
        cells[:, leading:],
        labels,
        rate=used_rate,
        unit=unit_from(unit, "mm"),
        zeros_missing=zeros_missing,
    )


def _header(table: Table) -> tuple[dict[str, Row], Row]:
    """Return the facts by name, and the last row before the frames."""
    facts: dict[str, Row] = {}
    last = table.opening[0]
    for row in table.rows():
        name = row.cells[0]
        named = "MARKER_NAMES" in facts
        if not _FACT.fullmatch(name) or is_number(name) or (named and "TRAJ" not in name):
            # A row of the columns' names comes before the frames, or the first of these.
            return facts, row if _names_columns(row) else last
        facts.setdefault(name, row)
        last = row
    return facts, last


def _names_columns(row: Row) -> bool:
    return any(cell and not is_number(cell) and cell.upper() != "NULL" for cell in row.cells)


def _check_kind(table: Table, facts: Mapping[str, Row]) -> None:
    kind = facts.get("DATA_INCLUDED")
    if kind is not None and kind.cells[1:2] != ["3D"]:
        raise ValueError(
            f"{table.place(kind, 1)}: DATA_INCLUDED is "
            f"{quoted(' '.join(kind.cells[1:]).strip())}; only 3D data are a recording of markers"
        )
    if "MARKER_NAMES" not in facts or filled_width(facts["MARKER_NAMES"].cells) < 2:
        raise ValueError(f"{table.path}: no names follow MARKER_NAMES in the header")


def _rate(table: Table, facts: Mapping[str, Row], setting: float | None) -> float:
    comment = stated_rate(table)
    row = facts.get("FREQUENCY")
    written = "".join(row.cells[1:2]) if row else ""
    place = table.place(row, 1) if row else str(table.path)
    return rate_of_header(setting, str(comment or written), place, "FREQUENCY")


def _shape(table: Table, header: Row, named: int) -> tuple[int, int]:
    """Return how many columns come before the coordinates, and how many there are in all."""
    first = next(table.rows(header.end, header.line + 1), None)
    if first is None:
        return 0, 3 * named
    words = [cell.lower() for cell in header.cells[:_LEADING]]
    there = len(first.cells)
    leading = _LEADING if words == ["frame", "time"] or there - 3 * named == _LEADING else 0
    # A tab may end each line.
    for ending in (0, 1):
        if there - ending - leading == 3 * named:
            return leading, there - ending
    width = there - (first.cells[-1] == "")
    if (width - leading) % 3 or width == leading:
        raise ValueError(
            f"{table.path}:{first.line}: {width - leading} coordinates make no whole number of "
            f"markers; MARKER_NAMES has {named}"
        )
    return leading, width


def _warn_facts(facts: Mapping[str, Row], frames: int, markers: int) -> None:
    for fact, what, there in (
        ("NO_OF_FRAMES", "frames", frames),
        ("NO_OF_MARKERS", "markers", markers),
    ):
        if fact in facts:
            warn_count(what, "".join(facts[fact].cells[1:2]), there)
    types = facts.get("TRAJECTORY_TYPES")
    if types is not None:
        _warn_types(types.cells[1:], facts["MARKER_NAMES"].cells[1:])


def _warn_types(types: Sequence[str], labels: Sequence[str]) -> None:
    computed = [
        f"{label} ({kind})"
        for label, kind in zip(labels, types, strict=False)
        if kind and not kind.lower().startswith("measured")
    ]
    if computed:
        warnings.warn(
            f"{len(computed)} trajectories are not wholly measured, by TRAJECTORY_TYPES; their "
            f"samples count as measured all the same: {', '.join(computed)}",
            stacklevel=4,
        )
