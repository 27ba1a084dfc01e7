"""Recordings as TRC files (track row column): a row of text per frame, as OpenSim reads them.

Five lines come first: the form of the file, names of facts, the facts, the markers' names over the
first of their columns, and the columns' own names X1, Y1, Z1, X2, ... Source: OpenSim
documentation, "Marker (.trc) Files".
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from nodegraph import Format, quoted
from nodegraph_files.text.table import Row, Table, filled, filled_width, read_rows
from nodegraph_files.text.table_recording import (
    is_number,
    rate_of_header,
    recording_of,
    warn_count,
    warn_other_rate,
    warn_skipped,
)
from nodegraph_files.text.text_file import read_text_file, start_in_utf8
from nodegraph_files.text.vicon import LEADING, count_triples, labels_over
from nodegraph_files.units import AUTO, unit_from
from nodegraph_mocap.recording import Trajectories

_FIRST_WORD = "PathFileType"
_HEADER_LINES = 5


def read_trc(
    path: Path, *, zeros_missing: bool = True, unit: str = AUTO, rate: float | None = None
) -> Trajectories:
    """Read a recording from a TRC file, whose cells tabs or commas separate.

    The columns and rows that are there count, not the numbers of the header. Warnings say where
    the two differ, that names stand over other columns, that the row of X1, Y1, Z1, ... lacks, how
    many columns were left out as they follow the last of it, which markers lacked a name or shared
    one, how many samples were partly missing, infinite or zero, how many rows end early, and
    whether frame numbers or times contradict evenly spaced frames.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    unit
        Unit of length, such as ``cm``; by default what the header states.
    rate
        Hz; by default the header's DataRate.

    Returns
    -------
    Trajectories
        In millimetres; a sample whose cells are empty is missing. A
        subject's prefix (``subject:marker``) that all markers share is taken off their names.

    Raises
    ------
    ValueError
        With the file, and where there are any with line and column: if it is not a TRC file, a cell
        is not a number, a name or column is out of place, or the rate or all frames are lacking.
    """
    table = _table(path)
    header = _header(table)
    facts = header.facts
    used_rate = rate_of_header(rate, facts.get("datarate", ""), str(path), "DataRate")
    markers = _count(table, header)
    labels = _labels(table, header.names, markers)
    width = LEADING + 3 * markers
    # trajectories without names; between commas, they may be the decimals of others
    beyond = 0 if table.separator == "," else 3
    rows = table.below(header.last, width, range(width), lenient=True, beyond=beyond)
    cells = filled(read_rows(rows))
    if not len(cells):
        stated = facts.get("numframes") or "none"
        raise ValueError(f"{path}: no frames follow the header, whose NumFrames says {stated}")
    warn_count("frames", facts.get("numframes", str(len(cells))), len(cells))
    warn_count("markers", facts.get("nummarkers", str(markers)), markers)
    warn_skipped("Frame#", cells[:, 0])
    warn_other_rate(cells[:, 1], used_rate, "DataRate" if rate is None else "`rate`")
    return recording_of(
        cells[:, LEADING:],
        labels,
        rate=used_rate,
        unit=unit_from(unit, facts.get("units", "")),
        zeros_missing=zeros_missing,
    )


def write_trc(recording: Trajectories, path: Path) -> None:
    """Write a recording as a TRC file; see `trc_bytes`."""
    path.write_bytes(trc_bytes(recording))


def trc_bytes(recording: Trajectories) -> bytes:
    """Return a recording as TRC in millimetres; rate and every number read back equal.

    Names do as well, but for a subject's prefix that all of them share, which readers take off.

    Raises
    ------
    ValueError
        If there is no frame or no marker, or a marker's name cannot stand in a cell: it is empty,
        starts or ends with a space, or contains a character that is not printed.
    """
    _check_writable(recording)
    frames, count, rate = recording.frames, len(recording.markers), repr(recording.rate)
    facts = {
        "DataRate": rate, "CameraRate": rate, "NumFrames": frames, "NumMarkers": count,
        "Units": "mm", "OrigDataRate": rate, "OrigDataStartFrame": 1, "OrigNumFrames": frames,
    }  # fmt: skip
    axes = [f"{axis}{marker}" for marker in range(1, count + 1) for axis in "XYZ"]
    lines = [
        f"{_FIRST_WORD}\t4\t(X/Y/Z)\trecording.trc",
        "\t".join(facts),
        "\t".join(str(value) for value in facts.values()),
        "\t".join(["Frame#", "Time", *(f"{name}\t\t" for name in recording.markers)]),
        "\t".join(["", "", *axes]),
        "",
    ]
    for frame, row in enumerate(recording.positions.reshape(frames, -1).tolist()):
        numbers = ("" if number != number else repr(number) for number in row)
        lines.append("\t".join([str(frame + 1), repr(frame / recording.rate), *numbers]))
    return ("\n".join(lines) + "\n").encode()


def _check_writable(recording: Trajectories) -> None:
    if not recording.frames or not recording.markers:
        raise ValueError(
            f"TRC holds at least one frame of one marker, not {recording.frames} of "
            f"{len(recording.markers)}"
        )
    for name in recording.markers:
        if not name or not name.isprintable() or name != name.strip():
            raise ValueError(f"TRC cannot keep the marker name {quoted(name)}")


def _table(path: Path) -> Table:
    text = read_text_file(path)
    first = next((line.text for line in text.lines()), "")
    if not first.startswith(_FIRST_WORD):
        raise ValueError(f"{path}: no TRC file: it begins with {quoted(first)}, not {_FIRST_WORD}")
    separator = max("\t,", key=first.count)
    if separator not in first:
        raise ValueError(f"{path}:1: neither tabs nor commas separate cells")
    return Table(text, {}, separator, [], quoted=False)


@dataclass(frozen=True)
class _Header:
    """The facts by name in small letters, the row of names, and that of X1, Y1, ... if any."""

    facts: Mapping[str, str]
    names: Row
    axes: Row | None

    @property
    def last(self) -> Row:
        """The row below which the numbers begin."""
        return self.axes or self.names


def _header(table: Table) -> _Header:
    rows = list(islice(table.rows(), _HEADER_LINES))
    if len(rows) < _HEADER_LINES:
        raise ValueError(
            f"{table.path}: the header ends after {len(rows)} of {_HEADER_LINES} lines"
        )
    _, keys, values, names, axes = rows
    # Values that are padded by tabs are as many as the keys, but not below them.
    written = [value for value in values.cells if value]
    paired = written if len(written) == filled_width(keys.cells) else values.cells
    facts = {key.lower(): value for key, value in zip(keys.cells, paired, strict=False)}
    return _Header(facts, names, None if is_number(axes.cells[0]) else axes)


def _count(table: Table, header: _Header) -> int:
    """Return the number of markers: of columns X1, Y1, Z1, ..., or of those that have numbers."""
    if header.axes is None:
        rows = table.rows(header.last.end, header.last.line + 1)
        there = max((filled_width(row.cells) for row in rows), default=0)
        if there <= LEADING or (there - LEADING) % 3:
            raise ValueError(
                f"{table.path}:{header.last.line + 1}: no columns X1, Y1, Z1, ... and "
                f"{max(there - LEADING, 0)} coordinates, which make no whole number of markers"
            )
        warnings.warn("no row X1, Y1, Z1, ... in the header; the cells count", stacklevel=3)
        return (there - LEADING) // 3
    # Some programs write the row without the cells that come first, or with more.
    leading = next(place for place, cell in enumerate(header.axes.cells) if cell)
    return count_triples(table.path, header.axes.line, header.axes.cells, leading)


def _labels(table: Table, names: Row, markers: int) -> Sequence[str]:
    """Return the names, which stand over X columns, or else are as many as markers."""
    written = [name for name in names.cells[LEADING:] if name]
    try:
        return labels_over(table.path, names.line, names.cells)
    except ValueError:
        if len(written) != markers:
            raise
    warnings.warn("names do not stand over X columns; they are taken in order", stacklevel=3)
    return written


def _is_trc(start: bytes) -> bool:
    return start_in_utf8(start).startswith(_FIRST_WORD.encode())


FORMAT = Format("TRC", Trajectories, (".trc",), read_trc, _is_trc)
