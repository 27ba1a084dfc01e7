"""Recordings as long ("tidy") tables: a row per frame and marker."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.text.cells import split_cells
from nodegraph_mocap.text.columns import Columns, is_frame, seconds_in, tell_left_out
from nodegraph_mocap.text.frame_times import whole_steps
from nodegraph_mocap.text.rows import Rows, read_rows
from nodegraph_mocap.text.table_recording import known_rate, recording_of, told_scale
from nodegraph_mocap.text.table_text import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

_MARKER = {"marker", "label", "name", "keypoint", "landmark", "bodypart", "marker_name"}
_AXES = ("x", "y", "z")
_SPARSEST = 100  # samples per row, above which a table holds something else
_FEW = 10_000_000  # samples for which there is room in any case


def is_long(table: Table) -> bool:
    """Return whether the first row names columns of markers, of x, and of frames or times."""
    names = table.opening[0].cells
    small = {name.lower() for name in names}
    counted = any(is_frame(name) or seconds_in(name) is not None for name in names)
    return bool(small & _MARKER) and "x" in small and counted


def read_long(table: Table, *, zeros_missing: bool) -> Trajectories:
    """Read a recording from columns frame or time, marker, x, y and z, in any order.

    A row that is not there is a missing sample, and so are those of frames that are skipped; a
    warning counts these. Where steps from frame to frame are no whole multiples of the usual
    one, the frames count as evenly spaced, which a warning tells.

    Raises
    ------
    ValueError
        With file and line, if a column lacks or is there twice, a frame has a marker twice, a row
        has no frame or no marker; with the file, if there are far fewer rows than samples, or no
        rate.
    """
    columns, marker = _columns(table)
    coordinates = list(columns.markers[""].values())
    wanted = sorted([*columns.counters, *coordinates])
    rows = table.below(columns.header, len(columns.names), wanted, names=columns.names)
    read = dict(zip(wanted, read_rows(rows).T, strict=True))
    labels = [split_cells(line.text, rows.separator)[marker].strip() for line in rows.lines()]
    if not labels:
        raise ValueError(f"{table.path}: no frames follow line {columns.header.line}")
    frames = _frames(rows, columns, read, labels)
    names = {label: place for place, label in enumerate(dict.fromkeys(labels))}
    of_marker = np.array([names[label] for label in labels])
    _check_samples(rows, frames, of_marker, list(names))
    positions = np.full((int(frames.max()) + 1, len(names), 3), np.nan)
    for axis, name in enumerate(_AXES):
        positions[frames, of_marker, axis] = read[columns.markers[""][name]]
    return recording_of(
        positions.reshape(len(positions), -1),
        list(names),
        rate=known_rate(table, _times(columns, read)),
        millimetres=told_scale(table),
        zeros_missing=zeros_missing,
    )


def _columns(table: Table) -> tuple[Columns, int]:
    """Return which column holds what, and which the names of markers."""
    header = table.opening[0]
    small = [name.lower() for name in header.cells]
    marker = next(place for place, name in enumerate(small) if name in _MARKER)
    columns = Columns(table, header, header.cells)
    columns.markers[""] = {}
    for place, name in enumerate(small):
        if name in _AXES:
            if name in columns.markers[""]:
                raise ValueError(f"{table.place(header, place)}: column {name!r} is there twice")
            columns.markers[""][name] = place
        elif place != marker:
            columns.add_other(place)
    lacking = [axis for axis in _AXES if axis not in columns.markers[""]]
    if lacking:
        raise ValueError(
            f"{table.path}:{header.line}: no column {', '.join(lacking)}; a recording has three "
            f"dimensions; there is {', '.join(header.cells)}"
        )
    tell_left_out(columns)
    return columns, marker


def _frames(
    rows: Rows, columns: Columns, read: dict[int, NDArray[np.float64]], labels: Sequence[str]
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
                f"the {len(there)} values of the column {name!r} are no whole steps apart; they "
                "count as evenly spaced frames",
                stacklevel=4,
            )
        return even
    frames = np.concatenate([[0.0], np.cumsum(steps)])
    skipped = int(frames[-1]) + 1 - len(there)
    if skipped > len(there):
        raise ValueError(
            f"{rows.text.path}: the column {name!r} goes from {there[0]:g} to {there[-1]:g}, but "
            f"only {len(there)} frames have rows, and {skipped} have none"
        )
    if skipped:
        warnings.warn(
            f"{skipped} frames have no row, by the column {name!r}; they are missing", stacklevel=4
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
            f"{rows.text.path}:{_line(rows, row)}: marker {names[of_marker[row]]!r} is in this "
            "frame already"
        )


def _times(columns: Columns, read: dict[int, NDArray[np.float64]]) -> NDArray[np.float64] | None:
    for column in columns.counters:
        seconds = seconds_in(columns.names[column])
        if seconds is not None:
            return np.unique(read[column]) * seconds
    return None


def _line(rows: Rows, row: int) -> int:
    return next(line.number for place, line in enumerate(rows.lines()) if place == row)
