"""Recordings as tables of text, in the forms in which programs write them."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np

from nodegraph import Format, listed, quoted
from nodegraph_files.text.counters import in_seconds, is_counter, is_frame, is_time
from nodegraph_files.text.motive import is_motive, read_motive
from nodegraph_files.text.openface import is_openface, read_openface
from nodegraph_files.text.qtm import is_qtm, read_qtm
from nodegraph_files.text.table import (
    SEPARATORS,
    Row,
    Rows,
    Table,
    filled_width,
    read_rows,
    read_table,
    split_cells,
)
from nodegraph_files.text.table_recording import (
    is_number,
    known_rate,
    rate_of_counters,
    recording_of,
    unit_of_table,
    whole_steps,
)
from nodegraph_files.text.vicon import is_vicon, read_vicon
from nodegraph_files.units import AUTO
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray


_DATE = re.compile(r"\d+-\d+-\d+|\d+:\d+")
_MOST_NAMES = 10
_AXIS = re.compile(r"([xyzXYZ])(?: *[\[(]([^\[\]()]*)[\])])?")
_COLUMN = re.compile(rf"(.*)[._: ]{_AXIS.pattern}")
_NUMBERED = re.compile(r"([xyz])_?(\d{1,9})", re.IGNORECASE)
_MEDIAPIPE = (468, 478)  # landmarks of a face, without and with the irises
_MOST_CELLS = 8
_MARKER = {"marker", "label", "name", "keypoint", "landmark", "bodypart", "marker_name"}
_AXES = ("x", "y", "z")
_EACH = "each marker"  # whose columns are the same
_SPARSEST = 100  # samples per row, above which a table holds something else
_FEW = 10_000_000  # samples for which there is room in any case
_COORDINATES = {*_AXES, "likelihood", "score", "confidence", "visibility"}
_LEADING = 2  # columns of an index at most


@dataclass
class CsvColumns:
    """The columns of a table by what they hold, counted from 0.

    Attributes
    ----------
    table : Table
    header : Row
        The row below which the numbers begin.
    names : sequence of str
        Names of all columns, for messages.
    markers : dict
        By marker and by axis, ``x``, ``y`` or ``z``.
    counters : list of int
        The columns of frame numbers or times.
    left_out : list of int
        The columns that are neither.
    unit : str
        Unit of length, as the names of the coordinates' columns state it, or empty.
    """

    table: Table
    header: Row
    names: Sequence[str]
    markers: dict[str, dict[str, int]] = field(default_factory=dict)
    counters: list[int] = field(default_factory=list)
    left_out: list[int] = field(default_factory=list)
    unit: str = ""

    def add_coordinate(self, marker: str, axis: str, column: int, unit: str = "") -> None:
        """Keep the column of a coordinate, and the unit that its name states.

        Raises
        ------
        ValueError
            With file, line and column, if the marker has no name, or that coordinate already, or
            another column states another unit.
        """
        axes = self.markers.setdefault(marker, {})
        if self.unit and unit and unit != self.unit:
            raise ValueError(
                f"{self.table.place(self.header, column)}: the column "
                f"{quoted(self.names[column])} is in {quoted(unit)}, but others are in "
                f"{quoted(self.unit)}"
            )
        self.unit = self.unit or unit
        if marker and axis.lower() not in axes:
            axes[axis.lower()] = column
            return
        wrong = "is there twice" if marker else "names no marker"
        raise ValueError(
            f"{self.table.place(self.header, column)}: the column {quoted(self.names[column])} "
            f"{wrong}"
        )

    @cached_property
    def _first(self) -> Sequence[str]:
        """The cells of the first row below the header, if there is one."""
        first = next(self.table.rows(self.header.end, self.header.line + 1), None)
        return first.cells if first else ()

    def add_other(self, column: int) -> None:
        """Keep a column that is not a coordinate; one of dates counts nothing."""
        is_date = _DATE.match("".join(self._first[column : column + 1]))
        counts = is_counter(self.names[column]) and not is_date
        (self.counters if counts else self.left_out).append(column)


def read_columns(
    columns: CsvColumns, *, zeros_missing: bool, unit: str, rate: float | None
) -> Trajectories:
    """Read the recording whose columns are known.

    Warnings say which columns were left out, and how many steps of frame numbers or times are
    irregular.

    Raises
    ------
    ValueError
        If a marker lacks a coordinate, there are no frames or no rate, or as `read_rows` does.
    """
    check_axes(columns)
    warn_left_out(columns)
    table = columns.table
    order = [axes[axis] for axes in columns.markers.values() for axis in "xyz"]
    wanted = sorted([*order, *columns.counters])
    names = columns.names
    cells = table.frames_below(columns.header, len(names), wanted, names=names)
    places = {column: place for place, column in enumerate(wanted)}
    counters = [(names[counter], cells[:, places[counter]]) for counter in columns.counters]
    return recording_of(
        _taken(cells, [places[column] for column in order]),
        list(columns.markers),
        rate=rate_of_counters(table, counters, rate),
        unit=unit_of_table(table, unit, columns.unit),
        zeros_missing=zeros_missing,
    )


def _taken(cells: NDArray[np.float64], places: list[int]) -> NDArray[np.float64]:
    """Return columns in that order, without a copy where they are neighbours already."""
    neighbours = slice(places[0], places[0] + len(places))
    return cells[:, neighbours if places == [*range(*neighbours.indices(2**62))] else places]


def check_axes(columns: CsvColumns) -> None:
    """Refuse markers that lack a coordinate."""
    path = columns.table.path
    lacking = {
        marker: [axis.upper() for axis in "xyz" if axis not in axes]
        for marker, axes in columns.markers.items()
    }
    if lacking and all(axes == ["Z"] for axes in lacking.values()):
        raise ValueError(
            f"{path}:{columns.header.line}: {len(lacking)} markers have X and Y and no Z; a "
            "recording has three dimensions"
        )
    for marker, axes in lacking.items():
        if axes:
            raise ValueError(
                f"{path}:{columns.header.line}: marker {quoted(marker)} has no column for "
                f"{', '.join(axes)}"
            )


def warn_left_out(columns: CsvColumns) -> None:
    """Warn of columns that are neither coordinates nor frame numbers nor times."""
    if columns.left_out:
        shown = [columns.names[column] or f"column {column + 1}" for column in columns.left_out]
        warnings.warn(
            f"{len(columns.left_out)} columns are not coordinates and were left out: "
            f"{listed(shown, _MOST_NAMES)}",
            stacklevel=4,
        )


def read_wide(table: Table, *, zeros_missing: bool, unit: str, rate: float | None) -> Trajectories:
    """Read a recording whose first row names the columns ``NAME.X, NAME.Y, NAME.Z``.

    Also with ``_``, ``:`` or a blank before the letter, with a unit in brackets after it, and in
    any order; or, if there are none of these, the columns ``x0, y0, z0, x1, ...``, also written
    ``x_0``, which are ``landmark_0``, ``landmark_1``, ... A warning says where there are as many
    as MediaPipe's landmarks of a face, which are no lengths unless they were made such.

    Raises
    ------
    ValueError
        If there are neither such columns, or a marker lacks one of its three.
    """
    header = table.opening[0]
    columns = CsvColumns(table, header, header.cells)
    is_named = any(map(_COLUMN.fullmatch, header.cells))
    for place, name in enumerate(header.cells):
        match, numbered = _COLUMN.fullmatch(name), _NUMBERED.fullmatch(name)
        if match:
            columns.add_coordinate(match[1], match[2], place, (match[3] or "").strip())
        elif numbered and not is_named:
            columns.add_coordinate(f"landmark_{int(numbered[2])}", numbered[1], place)
        else:
            columns.add_other(place)
    if not columns.markers:
        shown = listed(header.cells, _MOST_CELLS)
        weights = "; read.weights reads weights of blendshapes" if columns.left_out else ""
        raise ValueError(
            f"{table.path}:{header.line}: no columns NAME.X, NAME.Y, NAME.Z; there is {shown}"
            f"{weights}"
        )
    _warn_of_pictures(len(columns.markers), unit)
    return read_columns(columns, zeros_missing=zeros_missing, unit=unit, rate=rate)


def _warn_of_pictures(markers: int, unit: str) -> None:
    if markers in _MEDIAPIPE and unit == AUTO:
        warnings.warn(
            f"{markers} landmarks, as MediaPipe finds in a face: its x and z are shares of a "
            "picture's width, and y of its height, and no lengths; multiply them by these, scale "
            "them to the size of the face, and set `unit`",
            stacklevel=4,
        )


def is_long(table: Table) -> bool:
    """Return whether the first row names columns of markers, of x, and of frames or times."""
    names = table.opening[0].cells
    small = {name.lower() for name in names}
    axes = {match[1].lower() for match in map(_AXIS.fullmatch, names) if match}
    counted = any(map(is_counter, names))
    return bool(small & _MARKER) and "x" in axes and counted


def read_long(table: Table, *, zeros_missing: bool, unit: str, rate: float | None) -> Trajectories:
    """Read a recording from columns frame or time, marker, x, y and z, in any order.

    A row that is not there is a missing sample, and so are those of frames that are skipped; a
    warning counts these. Where steps from frame to frame are not whole multiples of the usual
    one, the frames count as evenly spaced, with a warning.

    Raises
    ------
    ValueError
        With file and line, if a column lacks or is there twice, a frame has a marker twice, a row
        has no frame or no marker; with the file, if there are far fewer rows than samples, or no
        rate.
    """
    columns, marker = _columns(table)
    coordinates = list(columns.markers[_EACH].values())
    wanted = sorted([*columns.counters, *coordinates])
    rows = table.below(columns.header, len(columns.names), wanted, names=columns.names)
    read = dict(zip(wanted, read_rows(rows).T, strict=True))
    labels = [split_cells(line.text, rows.separator)[marker].strip() for line in rows.lines()]
    if not labels:
        raise ValueError(f"{table.path}: no frames follow line {columns.header.line}")
    frames = _frames(rows, columns, read, labels)
    _warn_of_pictures(len(set(labels)), unit)
    names = {label: place for place, label in enumerate(dict.fromkeys(labels))}
    of_marker = np.array([names[label] for label in labels])
    _check_samples(rows, frames, of_marker, list(names))
    positions = np.full((int(frames.max()) + 1, len(names), 3), np.nan)
    for axis, name in enumerate(_AXES):
        positions[frames, of_marker, axis] = read[columns.markers[_EACH][name]]
    return recording_of(
        positions.reshape(len(positions), -1),
        list(names),
        rate=known_rate(table, _times(columns, read), rate),
        unit=unit_of_table(table, unit, columns.unit),
        zeros_missing=zeros_missing,
    )


def _columns(table: Table) -> tuple[CsvColumns, int]:
    """Return which column holds what, and which the names of markers."""
    header = table.opening[0]
    marker = next(place for place, name in enumerate(header.cells) if name.lower() in _MARKER)
    columns = CsvColumns(table, header, header.cells)
    columns.markers[_EACH] = {}
    for place, name in enumerate(header.cells):
        if match := _AXIS.fullmatch(name):
            columns.add_coordinate(_EACH, match[1], place, (match[2] or "").strip())
        elif place != marker:
            columns.add_other(place)
    lacking = [axis for axis in _AXES if axis not in columns.markers[_EACH]]
    if lacking:
        raise ValueError(
            f"{table.path}:{header.line}: no column {', '.join(lacking)}; a recording has three "
            f"dimensions; there is {listed(header.cells)}"
        )
    warn_left_out(columns)
    return columns, marker


def _frames(
    rows: Rows, columns: CsvColumns, read: dict[int, NDArray[np.float64]], labels: Sequence[str]
) -> NDArray[np.int64]:
    """Return the frame of each row, counted from 0."""
    numbers = [column for column in columns.counters if is_frame(columns.names[column])]
    column = (numbers or columns.counters)[0]
    for row, (value, label) in enumerate(zip(read[column].tolist(), labels, strict=True)):
        if not np.isfinite(value) or not label:
            what = "marker" if not label else columns.names[column]
            raise ValueError(f"{rows.text.path}:{_line(rows, row)}: the row has no {what}")
    there, place = np.unique(read[column], return_inverse=True)
    return np.asarray(_grid(rows, columns.names[column], there)[place])


def _grid(rows: Rows, name: str, there: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return which frame each of the different frame numbers or times is."""
    even = np.arange(len(there))
    steps = whole_steps(there)
    if steps is None:
        if len(there) > 1:
            warnings.warn(
                f"the {len(there)} values of the column {quoted(name)} are not whole steps apart; "
                "they count as evenly spaced frames",
                stacklevel=4,
            )
        return even
    frames = np.concatenate([[0.0], np.cumsum(steps)])
    skipped = int(frames[-1]) + 1 - len(there)
    if skipped > len(there):
        raise ValueError(
            f"{rows.text.path}: the column {quoted(name)} goes from {there[0]:g} to "
            f"{there[-1]:g}, but only {len(there)} frames have rows, and {skipped} have none"
        )
    if skipped:
        warnings.warn(
            f"{skipped} frames have no row, by the column {quoted(name)}; they are missing",
            stacklevel=4,
        )
    return frames.astype(np.int64)


def _check_samples(
    rows: Rows, frames: NDArray[np.int64], of_marker: NDArray[np.int64], names: Sequence[str]
) -> None:
    samples = (int(frames.max()) + 1) * len(names)
    if samples > max(_SPARSEST * len(frames), _FEW):
        raise ValueError(
            f"{rows.text.path}: {len(frames)} rows cannot be {samples} samples of {len(names)} "
            "markers; does the column of markers name something else?"
        )
    order = np.lexsort((of_marker, frames))
    again = (np.diff(frames[order]) == 0) & (np.diff(of_marker[order]) == 0)
    if again.any():
        row = int(order[1:][again].min())
        raise ValueError(
            f"{rows.text.path}:{_line(rows, row)}: marker {quoted(names[of_marker[row]])} is in "
            "this frame already"
        )


def _times(columns: CsvColumns, read: dict[int, NDArray[np.float64]]) -> NDArray[np.float64] | None:
    for column in columns.counters:
        if is_time(columns.names[column]):
            return in_seconds(columns.names[column], np.unique(read[column]))
    return None


def _line(rows: Rows, row: int) -> int:
    return next(line.number for place, line in enumerate(rows.lines()) if place == row)


def is_levels(table: Table) -> bool:
    """Return whether a row below another has nothing but axes, after the columns of an index."""
    return _levels(table) > 0


def read_levels(
    table: Table, *, zeros_missing: bool, unit: str, rate: float | None
) -> Trajectories:
    """Read a recording whose columns have a marker's name in one row, and an axis in a later one.

    Levels in which all columns share a name, such as a scorer, are left out of the markers'
    names; others are joined by ``:``. The index holds frame numbers, unless it is named
    ``time``. Columns that say how likely a position is are left out, with a warning.

    Raises
    ------
    ValueError
        With file and line, if the rows of names are not of one length; or as `read_columns`
        does.
    """
    count = _levels(table)
    levels, axes = table.opening[:count], table.opening[count]
    width, leading = filled_width(axes.cells), _leading(axes)
    header, index = _index(table, axes, leading)
    labels = _labels(table, levels, leading, width)
    names = [f"{label} {axis}" for label, axis in zip(labels, axes.cells[leading:], strict=False)]
    columns = CsvColumns(table, header, [*index, *names])
    for column in range(leading):
        columns.add_other(column)
    for column, label in enumerate(labels, leading):
        if axes.cells[column].lower() in _AXES:
            columns.add_coordinate(label, axes.cells[column], column)
        else:
            columns.left_out.append(column)
    return read_columns(columns, zeros_missing=zeros_missing, unit=unit, rate=rate)


def _levels(table: Table) -> int:
    """Return how many rows of names stand above the axes, or 0 if there are no axes."""
    for place, row in enumerate(table.opening):
        leading = _leading(row)
        axes = {cell.lower() for cell in row.cells[leading : filled_width(row.cells)]}
        if place and leading <= _LEADING and {"x", "y"} <= axes <= _COORDINATES:
            return place
    return 0


def _leading(axes: Row) -> int:
    """Return how many columns stand before the first axis."""
    coordinates = (place for place, cell in enumerate(axes.cells) if cell.lower() in _AXES)
    return next(coordinates, len(axes.cells))


def _index(table: Table, axes: Row, leading: int) -> tuple[Row, list[str]]:
    """Return the last row of the header, and the names of the index's columns.

    If the index has a name, a row of its own holds it; if it has none but holds numbers, it
    counts frames.
    """
    below = next(table.rows(axes.end, axes.line + 1), None)
    if below is None:
        return axes, ["index"] * leading
    first = below.cells[:leading]
    if filled_width(below.cells) <= leading and not all(is_number(cell) for cell in first):
        return below, first
    return axes, ["index" if is_number(cell) else "" for cell in first]


def _labels(table: Table, levels: Sequence[Row], leading: int, width: int) -> list[str]:
    named = []
    for row in levels:
        if filled_width(row.cells) != width:
            raise ValueError(
                f"{table.path}:{row.line}: names in {filled_width(row.cells)} columns, but the "
                f"axes are in {width}"
            )
        named.append(row.cells[leading:width])
    differing = [names for names in named if len(set(names)) > 1] or named[-1:]
    return [":".join(parts) for parts in zip(*differing, strict=True)]


class _Read(Protocol):
    def __call__(
        self, table: Table, *, zeros_missing: bool, unit: str, rate: float | None
    ) -> Trajectories: ...


_FORMS: tuple[tuple[Callable[[Table], bool], _Read], ...] = (
    (is_qtm, read_qtm),
    (is_motive, read_motive),
    (is_vicon, read_vicon),
    (is_openface, read_openface),
    (is_long, read_long),
    (is_levels, read_levels),
)


def read_csv(
    path: Path, *, zeros_missing: bool = True, unit: str = AUTO, rate: float | None = None
) -> Trajectories:
    """Read a recording from a table of text; its first rows decide the form.

    Exports of Qualisys Track Manager (TSV), OptiTrack Motive and Vicon Nexus; tables of OpenFace,
    of which the points in space are read; long tables of columns frame or time, marker, x, y, z;
    tables with a row of markers above a row of axes, as pandas and DeepLabCut write them; and
    tables with columns ``NAME.X, NAME.Y, NAME.Z`` or ``x0, y0, z0, x1, ...``. Commas, semicolons
    or tabs separate cells. Empty cells and ``NaN`` are missing. The text is in UTF-8, or in UTF-16
    with a byte order mark.

    Where the form itself does not hold them, the rate comes from a line ``# rate: 60`` or from
    a column ``time`` in seconds (``time (ms)`` in milliseconds) or ``timestamp``, whose unit its
    steps decide if its name does not. The unit of length comes from the names of columns
    (``x [cm]``, ``nose.X (m)``) or from a line ``# unit: mm``.

    Warnings say whatever was left out, assumed, or counts as missing; the readers of the single
    forms say which.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.
    unit
        Unit of length, such as ``cm``; by default what the file states.
    rate
        Hz; by default the file's own.

    Returns
    -------
    Trajectories
        In millimetres. A subject's prefix (``subject:marker``) that all markers share is taken
        off their names.

    Raises
    ------
    ValueError
        With file, line and column, as far as there are any: if a cell is not a number, a coordinate
        has no column, frames, rate or names lack, or commas may mean two things.
    """
    table = read_table(path)
    # a table that has no other form is expected to name its columns
    read = next((read for recognizes, read in _FORMS if recognizes(table)), read_wide)
    return read(table, zeros_missing=zeros_missing, unit=unit, rate=rate)


def write_csv(recording: Trajectories, path: Path) -> None:
    """Write a recording as a CSV file; see `csv_bytes`."""
    path.write_bytes(csv_bytes(recording))


def csv_bytes(recording: Trajectories) -> bytes:
    """Return a recording as CSV with columns ``NAME.X``; rate and every number read back equal.

    Names do as well, but for a subject's prefix that all of them share, which readers take off.

    Raises
    ------
    ValueError
        If a marker's name cannot stand in a line: it is empty, starts or ends with a space, or
        contains a character that is not printed.
    """
    unfit = [name for name in recording.markers if not name.isprintable() or name != name.strip()]
    if unfit or "" in recording.markers:
        raise ValueError(f"CSV cannot keep the marker name {quoted((unfit or [''])[0])}")
    target = StringIO()
    target.write(f"# rate: {recording.rate!r}\n# unit: mm\n")
    names = [f"{marker}.{axis}" for marker in recording.markers for axis in "XYZ"]
    special = any(set(name) & set(f'{SEPARATORS}"') for name in names)
    writer = csv.writer(
        target, quoting=csv.QUOTE_ALL if special else csv.QUOTE_MINIMAL, lineterminator="\n"
    )
    writer.writerow(["frame", *names])
    for frame, row in enumerate(recording.positions.reshape(recording.frames, -1).tolist()):
        numbers = ("" if number != number else repr(number) for number in row)
        target.write(f"{frame},{','.join(numbers)}\n")
    return target.getvalue().encode()


FORMAT = Format("table of text", Trajectories, (".csv", ".tsv", ".txt"), read_csv)
