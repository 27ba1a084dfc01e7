"""Recordings as OpenFace writes them to text: points of a face that it follows in a video.

The first row names the columns: ``frame``, ``timestamp`` in seconds, ``confidence``, ``success``,
``x_0 ... y_67`` in pixels, ``X_0 ... Z_67`` in millimetres from the camera, and others. Names of
columns differ by case alone. Source: OpenFace, documentation, "Output Format".
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_files.text.table import Row, Table, check_distinct
from nodegraph_files.text.table_recording import known_rate, recording_of, warn_skipped
from nodegraph_files.units import unit_from
from nodegraph_mocap.recording import Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_POINT = re.compile(r"([XYZ])_(\d{1,4})")
_AXES = "XYZ"
_COUNTERS = ("frame", "timestamp", "success", "face_id")
_PIXELS, _SUCCESS = "x_0", "success"
_MOST_NAMES = 6


def is_openface(table: Table) -> bool:
    """Return whether the first row names points in pixels, and points in space or successes."""
    names = table.opening[0].cells
    return _PIXELS in names and ("X_0" in names or {_SUCCESS, "confidence"} <= set(names))


def read_openface(
    table: Table, *, zeros_missing: bool, unit: str, rate: float | None
) -> Trajectories:
    """Read the points in space of a table by OpenFace, as ``landmark_0`` to ``landmark_67``.

    The lengths are in millimetres in the axes of the camera: x to the right of the picture, y
    down, z away. Points in frames of which the column ``success`` says 0 are missing, with a
    warning that counts the frames; another says which columns were left out, such as points in
    pixels, gaze, head pose and action units.

    Raises
    ------
    ValueError
        With file and line, if there are no points in space, one of them lacks a column, a column
        is there twice, a cell is not a number, or the table holds several faces; with the file,
        if there are no frames, or no rate.
    """
    header = table.opening[0]
    points = _points(table, header)
    counters = {name: header.cells.index(name) for name in _COUNTERS if name in header.cells}
    order = [column for axes in points.values() for column in axes]
    wanted = sorted([*order, *counters.values()])
    _warn_left_out(header.cells, wanted)
    numbers = table.frames_below(header, len(header.cells), wanted, names=header.cells)
    cells = dict(zip(wanted, numbers.T, strict=True))
    read = {name: cells[column] for name, column in counters.items()}
    coordinates = np.stack([cells[column] for column in order], axis=1)
    _check_faces(table, read.get("face_id"))
    if "frame" in read:
        warn_skipped("frame", read["frame"])
    if _SUCCESS in read:
        _leave_failed(coordinates, read[_SUCCESS])
    return recording_of(
        coordinates,
        [f"landmark_{point}" for point in points],
        rate=known_rate(table, read.get("timestamp"), rate),
        unit=unit_from(unit, "mm"),
        zeros_missing=zeros_missing,
    )


def _points(table: Table, header: Row) -> dict[int, list[int]]:
    """Return the columns of x, y and z of each point."""
    check_distinct(header.cells, f"{table.path}:{header.line}")
    columns = {name: place for place, name in enumerate(header.cells)}
    numbers = sorted({int(match[2]) for match in map(_POINT.fullmatch, columns) if match})
    if not numbers:
        raise ValueError(
            f"{table.path}:{header.line}: OpenFace's points in pixels alone, x_0, y_0, ...; "
            "it writes those in space, X_0, Y_0, Z_0, ..., with the option -3Dfp"
        )
    for number in numbers:
        for axis in _AXES:
            if f"{axis}_{number}" not in columns:
                raise ValueError(f"{table.path}:{header.line}: no column {axis}_{number}")
    return {number: [columns[f"{axis}_{number}"] for axis in _AXES] for number in numbers}


def _warn_left_out(names: Sequence[str], wanted: Sequence[int]) -> None:
    taken = set(wanted)
    others = [name for place, name in enumerate(names) if place not in taken]
    if others:
        warnings.warn(
            f"{len(others)} columns of OpenFace are no points in space and were left out: "
            f"{listed(others, _MOST_NAMES)}",
            stacklevel=4,
        )


def _check_faces(table: Table, faces: NDArray[np.float64] | None) -> None:
    if faces is not None and len(there := np.unique(faces)) > 1:
        raise ValueError(
            f"{table.path}: {len(there)} faces, by the column face_id; write a table of each: a "
            "recording is of one"
        )


def _leave_failed(coordinates: NDArray[np.float64], success: NDArray[np.float64]) -> None:
    """Mark the points of frames in which no face was found as missing."""
    failed = ~(success > 0)
    if failed.any():
        coordinates[failed] = np.nan
        warnings.warn(
            f"{np.count_nonzero(failed)} of {len(failed)} frames have success 0; their points are "
            f"missing; the first is row {int(np.argmax(failed)) + 1}",
            stacklevel=4,
        )
