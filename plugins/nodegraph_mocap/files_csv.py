"""Recordings as tables of text: a row per frame, three columns per marker."""

from __future__ import annotations

import csv
import re
import warnings
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.samples_missing import mark_missing
from nodegraph_mocap.text_cells import cell_numbers, text_lines
from nodegraph_mocap.units import MILLIMETRES, millimetres_in

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COLUMN = re.compile(r"(.+)[._: ]([xyzXYZ])(?: *[\[(].*[\])])?")
_COMMENT = re.compile(r"#\s*(\w+)\s*[:=]\s*(\S+)(?:\s+\w+)?")
_COUNTER = re.compile(r"(frame|time)\b.*", re.IGNORECASE)
_SEPARATORS = ",;\t"


@dataclass(frozen=True)
class _Text:
    """A table as it was written: comments by name, names of columns, lines with their numbers."""

    path: Path
    comments: dict[str, str]
    separator: str
    names: list[str]
    lines: list[tuple[int, str]]


def read_csv(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read a recording from CSV or TSV.

    The first line that is no comment names the columns: ``NAME.X, NAME.Y, NAME.Z`` (also with
    ``_``, ``:`` or a blank before the letter), in any order, separated by commas, semicolons or
    tabs. The rate comes from a comment ``# rate: 60`` or from a column ``time`` in seconds, the
    unit of length from ``# unit: mm`` (the default). Empty cells and ``NaN`` are missing.

    Warnings tell which columns were left out, and how many steps of ``frame`` or ``time`` are
    irregular: rows count as evenly spaced.

    Raises
    ------
    ValueError
        With file, line and column, if a cell is no number; with the file, if a coordinate has no
        column or the rate is nowhere.
    """
    text = _text(path)
    columns = _columns(text)
    cells = _cells(text)
    indices = [columns[marker][axis] for marker in columns for axis in "xyz"]
    positions = cells[:, indices].reshape(len(cells), len(columns), 3) * _scale(text)
    nothing = np.zeros(positions.shape[:2], dtype=np.bool_)
    return Trajectories(
        positions=mark_missing(positions, nothing, zeros_missing=zeros_missing),
        markers=tuple(columns),
        rate=_rate(text, cells),
    )


def write_csv(recording: Trajectories, path: Path) -> None:
    """Write a recording as a CSV file; see `csv_bytes`."""
    path.write_bytes(csv_bytes(recording))


def csv_bytes(recording: Trajectories) -> bytes:
    """Return a recording as CSV; names, rate and every number read back equal.

    Raises
    ------
    ValueError
        If a marker's name cannot stand in a line: it is empty, starts or ends with a space, or
        contains a character that is not printed.
    """
    unfit = [name for name in recording.markers if not name.isprintable() or name != name.strip()]
    if unfit or "" in recording.markers:
        raise ValueError(f"CSV cannot keep the marker name {(unfit or [''])[0]!r}")
    target = StringIO()
    target.write(f"# rate: {recording.rate!r}\n# unit: mm\n")
    names = [f"{marker}.{axis}" for marker in recording.markers for axis in "XYZ"]
    special = any(set(name) & set(f'{_SEPARATORS}"') for name in names)
    writer = csv.writer(
        target, quoting=csv.QUOTE_ALL if special else csv.QUOTE_MINIMAL, lineterminator="\n"
    )
    writer.writerow(["frame", *names])
    for frame, row in enumerate(recording.positions.reshape(recording.frames, -1).tolist()):
        numbers = ("" if number != number else repr(number) for number in row)
        target.write(f"{frame},{','.join(numbers)}\n")
    return target.getvalue().encode()


def _text(path: Path) -> _Text:
    lines = text_lines(path)
    comments = (_COMMENT.fullmatch(line.strip()) for line in lines)
    rows = [(number, line) for number, line in enumerate(lines, 1) if _is_row(line)]
    if len(rows) < 2:
        raise ValueError(f"{path}: no frames; a line of names and a line per frame are needed")
    unquoted = re.sub(r'"[^"]*"', "", rows[0][1])
    separator = max(_SEPARATORS, key=unquoted.count)
    return _Text(
        path=path,
        comments={found[1].lower(): found[2] for found in comments if found},
        separator=separator,
        names=[name.strip() for name in _split(rows[0][1], separator)],
        lines=rows[1:],
    )


def _is_row(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith("#")


def _split(line: str, separator: str) -> list[str]:
    if '"' not in line:
        return line.split(separator)
    return next(csv.reader([line], delimiter=separator, skipinitialspace=True))


def _cells(text: _Text) -> NDArray[np.float64]:
    cells = np.empty((len(text.lines), len(text.names)))
    for row, (number, line) in enumerate(text.lines):
        found = _split(line, text.separator)
        if len(found) != len(text.names):
            raise ValueError(
                f"{text.path}:{number}: {len(found)} cells, but {len(text.names)} columns have "
                "names"
            )
        cells[row] = cell_numbers(text.path, number, found, names=text.names)
    return cells


def _columns(text: _Text) -> dict[str, dict[str, int]]:
    columns: dict[str, dict[str, int]] = {}
    left_out = []
    for index, name in enumerate(text.names):
        found = _COLUMN.fullmatch(name)
        if found is None:
            left_out += [] if _COUNTER.fullmatch(name) else [name]
            continue
        axes = columns.setdefault(found[1], {})
        if found[2].lower() in axes:
            raise ValueError(f"{text.path}: column {name!r} is there twice")
        axes[found[2].lower()] = index
    _check_columns(text, columns)
    if left_out:
        warnings.warn(
            f"{len(left_out)} columns are no coordinates and were left out: "
            f"{', '.join(left_out[:10])}",
            stacklevel=3,
        )
    return columns


def _check_columns(text: _Text, columns: dict[str, dict[str, int]]) -> None:
    for marker, axes in columns.items():
        lacking = [axis.upper() for axis in "xyz" if axis not in axes]
        if lacking:
            raise ValueError(
                f"{text.path}: marker {marker!r} has no column for {', '.join(lacking)}"
            )
    if not columns:
        shown = ", ".join(text.names[:8])
        raise ValueError(f"{text.path}: no columns NAME.X, NAME.Y, NAME.Z; there is {shown}")


def _scale(text: _Text) -> float:
    unit = text.comments.get("unit", text.comments.get("units", "mm"))
    factor = millimetres_in(unit)
    if factor is None:
        raise ValueError(f"{text.path}: unit {unit!r}; there is {', '.join(MILLIMETRES)}")
    return factor


def _rate(text: _Text, cells: NDArray[np.float64]) -> float:
    steps = _steps(text, cells)
    if "rate" in text.comments:
        return _told_rate(text)
    usual = steps.get("time", np.empty(0))
    if not len(usual) or not np.median(usual) > 0:
        raise ValueError(
            f"{text.path}: no rate; add a line '# rate: 60' or a column 'time' in seconds"
        )
    # Nine digits: times are written with fewer, and their differences end in rounding errors.
    return float(f"{1.0 / np.median(usual):.9g}")


def _told_rate(text: _Text) -> float:
    said = text.comments["rate"]
    try:
        rate = float(said)
    except ValueError:
        rate = 0.0
    if not 0 < rate < float("inf"):
        raise ValueError(f"{text.path}: rate {said!r} is not a positive number") from None
    return rate


def _steps(text: _Text, cells: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Return the steps of the columns ``frame`` and ``time``, and tell of irregular ones."""
    steps = {}
    for index, name in enumerate(text.names):
        found = None if _COLUMN.fullmatch(name) else _COUNTER.fullmatch(name)
        if found and len(cells) > 1:
            steps[found[1].lower()] = here = np.diff(cells[:, index])
            irregular = ~(np.abs(here - np.median(here)) <= np.median(np.abs(here)) / 2)
            _tell_irregular(name, int(np.count_nonzero(irregular)), len(here))
    return steps


def _tell_irregular(name: str, irregular: int, steps: int) -> None:
    if irregular:
        warnings.warn(
            f"{irregular} of {steps} steps of the column {name!r} are irregular: frames were "
            "dropped or repeated; the rows count as evenly spaced",
            stacklevel=5,
        )
