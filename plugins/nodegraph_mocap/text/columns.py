"""Tables with a row per frame and three columns per marker, whatever names the columns."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from nodegraph import listed
from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.text.frame_times import tell_irregular
from nodegraph_mocap.text.rows import read_rows
from nodegraph_mocap.text.table_recording import known_rate, recording_of, told_scale
from nodegraph_mocap.text.table_text import Row, Table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_FRAME = re.compile(r"frames?(?:[ _]*(?:number|index|no\.?|id|#))?|index", re.IGNORECASE)
_TIME = re.compile(r"times?[ _]*[\[(]?\s*([a-z]*)\s*[\])]?", re.IGNORECASE)
_SECONDS = {"": 1.0, "ms": 0.001, "msec": 0.001, "millisecond": 0.001, "milliseconds": 0.001}
_SECONDS |= dict.fromkeys(("s", "sec", "second", "seconds"), 1.0)
_LISTED = 10


@dataclass
class Columns:
    """Which column holds what, counted from 0.

    Attributes
    ----------
    table : Table
    header : Row
        The row below which the numbers begin.
    names : sequence of str
        Of all columns, for messages.
    markers : dict
        By marker and by axis, ``x``, ``y`` or ``z``.
    counters : list of int
        The columns of frame numbers or times.
    left_out : list of int
        The columns that are neither.
    """

    table: Table
    header: Row
    names: Sequence[str]
    markers: dict[str, dict[str, int]] = field(default_factory=dict)
    counters: list[int] = field(default_factory=list)
    left_out: list[int] = field(default_factory=list)

    def add_coordinate(self, marker: str, axis: str, column: int) -> None:
        """Keep the column of a coordinate.

        Raises
        ------
        ValueError
            With file, line and column, if the marker has no name, or that coordinate already.
        """
        axes = self.markers.setdefault(marker, {})
        if marker and axis.lower() not in axes:
            axes[axis.lower()] = column
            return
        wrong = "is there twice" if marker else "names no marker"
        raise ValueError(
            f"{self.table.place(self.header, column)}: the column {self.names[column]!r} {wrong}"
        )

    def add_other(self, column: int) -> None:
        """Keep a column that is no coordinate."""
        is_counter = is_frame(self.names[column]) or seconds_in(self.names[column]) is not None
        (self.counters if is_counter else self.left_out).append(column)


def is_frame(name: str) -> bool:
    """Return whether a column of that name holds frame numbers."""
    return _FRAME.fullmatch(name.strip()) is not None


def seconds_in(name: str) -> float | None:
    """Return how many seconds the unit of a column of times is, or None if it holds none."""
    found = _TIME.fullmatch(name.strip())
    return _SECONDS.get(found[1].lower()) if found else None


def read_columns(columns: Columns, *, zeros_missing: bool) -> Trajectories:
    """Read the recording whose columns are known.

    Warnings tell which columns were left out, and how many steps of frame numbers or times are
    irregular.

    Raises
    ------
    ValueError
        If a marker lacks a coordinate, there are no frames or no rate, or as `read_rows` does.
    """
    check_axes(columns)
    tell_left_out(columns)
    table = columns.table
    order = [axes[axis] for axes in columns.markers.values() for axis in "xyz"]
    wanted = sorted([*order, *columns.counters])
    cells = read_rows(table.below(columns.header, len(columns.names), wanted, names=columns.names))
    if not len(cells):
        raise ValueError(f"{table.path}: no frames follow line {columns.header.line}")
    places = {column: place for place, column in enumerate(wanted)}
    return recording_of(
        _taken(cells, [places[column] for column in order]),
        list(columns.markers),
        rate=_rate(columns, {one: cells[:, places[one]] for one in columns.counters}),
        millimetres=told_scale(table),
        zeros_missing=zeros_missing,
    )


def _taken(cells: NDArray[np.float64], places: list[int]) -> NDArray[np.float64]:
    """Return columns in that order, without a copy where they are neighbours already."""
    neighbours = slice(places[0], places[0] + len(places))
    return cells[:, neighbours if places == [*range(*neighbours.indices(2**62))] else places]


def check_axes(columns: Columns) -> None:
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
                f"{path}:{columns.header.line}: marker {marker!r} has no column for "
                f"{', '.join(axes)}"
            )


def tell_left_out(columns: Columns) -> None:
    """Warn of columns that are neither coordinates nor frame numbers nor times."""
    if columns.left_out:
        shown = [columns.names[one] or f"column {one + 1}" for one in columns.left_out]
        warnings.warn(
            f"{len(columns.left_out)} columns are no coordinates and were left out: "
            f"{listed(shown, _LISTED)}",
            stacklevel=4,
        )


def _rate(columns: Columns, counters: dict[int, NDArray[np.float64]]) -> float:
    times = None
    for column, values in counters.items():
        name = columns.names[column]
        tell_irregular(name, values)
        seconds = seconds_in(name)
        times = values * seconds if seconds is not None and times is None else times
    return known_rate(columns.table, times)
