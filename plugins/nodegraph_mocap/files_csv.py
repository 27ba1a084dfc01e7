"""Recordings as tables of text: a row per frame, three columns per marker."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing
from nodegraph_mocap.units import MILLIMETRES

_COLUMN = re.compile(r"(.+?)[._: ]([xyzXYZ])(?: *[\[(].*[\])])?")
_COMMENT = re.compile(r"#\s*(\w+)\s*[:=]\s*(\S+)")
_MISSING = {"", "nan", "na", "null"}


def read_csv(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read a recording from CSV or TSV.

    The first line that is no comment names the columns: ``NAME.X, NAME.Y, NAME.Z`` (also with
    ``_``, ``:`` or a blank before the letter), in any order, separated by commas, semicolons or
    tabs. The rate comes from a comment ``# rate: 60`` or from a column ``time`` in seconds, the
    unit of length from ``# unit: mm`` (the default). Empty cells and ``NaN`` are missing.

    Raises
    ------
    ValueError
        With file, line and column, if a cell is no number, a coordinate has no column, or the
        rate is nowhere.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a table of text: {error}") from None
    comments = (_COMMENT.fullmatch(line.strip()) for line in lines)
    said = {found[1].lower(): found[2] for found in comments if found}
    rows = [(number, line) for number, line in enumerate(lines, 1) if _is_row(line)]
    if len(rows) < 2:
        raise ValueError(f"{path}: no frames; a line of names and a line per frame are needed")
    separator = max(",;\t", key=rows[0][1].count)
    names = [name.strip().strip('"') for name in rows[0][1].split(separator)]
    cells = _numbers(path, rows[1:], separator, len(names))
    columns = _columns(path, names)
    indices = [columns[marker][axis] for marker in columns for axis in "xyz"]
    positions = cells[:, indices].reshape(len(cells), len(columns), 3) * _scale(path, said)
    rate = _rate(path, said, names, cells)
    nothing = np.zeros(positions.shape[:2], dtype=np.bool_)
    positions = mark_missing(positions, nothing, zeros_missing=zeros_missing)
    return Trajectories(positions=positions, markers=tuple(columns), rate=rate)


def csv_bytes(recording: Trajectories) -> bytes:
    """Return a recording as CSV; every number reads back equal."""
    names = [f"{marker}.{axis}" for marker in recording.markers for axis in "XYZ"]
    flat = recording.positions.reshape(recording.frames, -1)
    rows = ([repr(float(x)) if x == x else "" for x in row] for row in flat)
    lines = [f"# rate: {recording.rate!r}", "# unit: mm", ",".join(["frame", *names])]
    lines += [",".join([str(frame), *row]) for frame, row in enumerate(rows)]
    return ("\n".join(lines) + "\n").encode()


def _is_row(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith("#")


def _numbers(
    path: Path, rows: Iterable[tuple[int, str]], separator: str, width: int
) -> NDArray[np.float64]:
    found = []
    for number, line in rows:
        cells = line.split(separator)
        if len(cells) != width:
            raise ValueError(f"{path}:{number}: {len(cells)} cells, but {width} columns have names")
        found.append([_number(path, number, column, cell) for column, cell in enumerate(cells, 1)])
    return np.array(found, dtype=np.float64)


def _number(path: Path, line: int, column: int, cell: str) -> float:
    text = cell.strip().strip('"')
    if text.lower() in _MISSING:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise ValueError(f"{path}:{line}:{column}: {text!r} is not a number") from None


def _columns(path: Path, names: list[str]) -> dict[str, dict[str, int]]:
    columns: dict[str, dict[str, int]] = {}
    for index, name in enumerate(names):
        found = _COLUMN.fullmatch(name)
        if found is None:
            continue
        axes = columns.setdefault(found[1], {})
        if found[2].lower() in axes:
            raise ValueError(f"{path}: column {name!r} is there twice")
        axes[found[2].lower()] = index
    for marker, axes in columns.items():
        lacking = [axis.upper() for axis in "xyz" if axis not in axes]
        if lacking:
            raise ValueError(f"{path}: marker {marker!r} has no column for {', '.join(lacking)}")
    if not columns:
        shown = ", ".join(names[:8])
        raise ValueError(f"{path}: no columns NAME.X, NAME.Y, NAME.Z; there is {shown}")
    return columns


def _scale(path: Path, said: dict[str, str]) -> float:
    unit = said.get("unit", said.get("units", "mm")).lower()
    if unit not in MILLIMETRES:
        raise ValueError(f"{path}: unit {unit!r}; there is {', '.join(MILLIMETRES)}")
    return MILLIMETRES[unit]


def _rate(path: Path, said: dict[str, str], names: list[str], cells: NDArray[np.float64]) -> float:
    if "rate" in said:
        try:
            return float(said["rate"])
        except ValueError:
            raise ValueError(f"{path}: rate {said['rate']!r} is not a number") from None
    lowered = [name.lower() for name in names]
    times = [index for index, name in enumerate(lowered) if re.fullmatch(r"time\b.*", name)]
    steps = np.diff(cells[:, times[0]]) if times else np.empty(0)
    if not len(steps) or not np.median(steps) > 0:
        raise ValueError(f"{path}: no rate; add a line '# rate: 60' or a column 'time' in seconds")
    return float(1.0 / np.median(steps))
