"""Recordings as tables whose columns are named after marker and axis: ``lip.X``, ``lip_y``."""

from __future__ import annotations

import re

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.text.columns import Columns, read_columns
from nodegraph_mocap.text.table_text import Table

_COLUMN = re.compile(r"(.*)[._: ]([xyzXYZ])(?: *[\[(].*[\])])?")
_SHOWN = 8


def is_wide(table: Table) -> bool:
    """Return True: a table that has no other form is expected to have this one."""
    del table
    return True


def read_wide(table: Table, *, zeros_missing: bool) -> Trajectories:
    """Read a recording whose first row names the columns ``NAME.X, NAME.Y, NAME.Z``.

    Also with ``_``, ``:`` or a blank before the letter, with a unit in brackets after it, and in
    any order.
    """
    header = table.opening[0]
    columns = Columns(table, header, header.cells)
    for place, name in enumerate(header.cells):
        found = _COLUMN.fullmatch(name)
        if found is None:
            columns.add_other(place)
        else:
            columns.add_coordinate(found[1], found[2], place)
    if not columns.markers:
        shown = ", ".join(header.cells[:_SHOWN])
        raise ValueError(
            f"{table.path}:{header.line}: no columns NAME.X, NAME.Y, NAME.Z; there is {shown}"
        )
    return read_columns(columns, zeros_missing=zeros_missing)
