"""Recordings as tables with several rows of names above each other, the last of them axes.

So ``pandas.DataFrame.to_csv`` writes columns of several levels, and so DeepLabCut writes its
results, whose levels are scorer, bodyparts and coords. Sources: documentation of pandas,
``DataFrame.to_csv`` and "MultiIndex"; documentation of DeepLabCut, "Standard data format".
"""

from __future__ import annotations

from collections.abc import Sequence

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.text.columns import Columns, read_columns
from nodegraph_mocap.text.frame_times import is_number
from nodegraph_mocap.text.table_text import Row, Table, filled_width

_AXES = {"x", "y", "z"}
_COORDINATES = _AXES | {"likelihood", "score", "confidence", "visibility"}
_LEADING = 2  # columns of an index at most


def is_levels(table: Table) -> bool:
    """Return whether a row below another has nothing but axes, after the columns of an index."""
    return _levels(table) > 0


def read_levels(table: Table, *, zeros_missing: bool) -> Trajectories:
    """Read a recording whose columns have a marker's name in one row, and an axis in a later one.

    Levels in which all columns share a name, such as a scorer, are left out of the markers'
    names; others are joined by ``:``. The index holds frame numbers, unless it is named
    ``time``. Columns that say how likely a position is are left out, which a warning tells.

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
    spoken = [f"{label} {axis}" for label, axis in zip(labels, axes.cells[leading:], strict=False)]
    columns = Columns(table, header, [*index, *spoken])
    for column in range(leading):
        columns.add_other(column)
    for column, label in enumerate(labels, leading):
        if axes.cells[column].lower() in _AXES:
            columns.add_coordinate(label, axes.cells[column], column)
        else:
            columns.left_out.append(column)
    return read_columns(columns, zeros_missing=zeros_missing)


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
