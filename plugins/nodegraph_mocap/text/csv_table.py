"""Recordings as tables of text, in the forms in which programs write them."""

from __future__ import annotations

import csv
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Protocol

from nodegraph_mocap.recording import Trajectories
from nodegraph_mocap.text.cells import SEPARATORS
from nodegraph_mocap.text.levels import is_levels, read_levels
from nodegraph_mocap.text.long import is_long, read_long
from nodegraph_mocap.text.motive import is_motive, read_motive
from nodegraph_mocap.text.qtm import is_qtm, read_qtm
from nodegraph_mocap.text.table_text import Table, read_table
from nodegraph_mocap.text.vicon import is_vicon, read_vicon
from nodegraph_mocap.text.wide import is_wide, read_wide


class _Read(Protocol):
    def __call__(self, table: Table, *, zeros_missing: bool) -> Trajectories: ...


_FORMS: tuple[tuple[Callable[[Table], bool], _Read], ...] = (
    (is_qtm, read_qtm),
    (is_motive, read_motive),
    (is_vicon, read_vicon),
    (is_long, read_long),
    (is_levels, read_levels),
    (is_wide, read_wide),
)


def read_csv(path: Path, *, zeros_missing: bool = True) -> Trajectories:
    """Read a recording from a table of text; its first rows tell the form.

    Exports of Qualisys Track Manager (TSV), OptiTrack Motive and Vicon Nexus; long tables of
    columns frame or time, marker, x, y, z; tables with a row of markers above a row of axes, as
    pandas and DeepLabCut write them; and tables with columns ``NAME.X, NAME.Y, NAME.Z``. Commas,
    semicolons or tabs separate cells. Empty cells and ``NaN`` are missing. The text is in UTF-8,
    or in UTF-16 with a byte order mark.

    Where the form itself does not tell them, the rate comes from a line ``# rate: 60`` or from
    a column ``time`` in seconds (``time (ms)`` in milliseconds), the unit of length from a line
    ``# unit: mm``, the default.

    Warnings tell whatever was left out, assumed, or counts as missing; the readers of the single
    forms say which.

    Parameters
    ----------
    path
        The file.
    zeros_missing
        Whether a sample at exactly (0, 0, 0) counts as missing.

    Returns
    -------
    Trajectories
        In millimetres. A subject's prefix (``subject:marker``) that all markers share is taken
        off their names.

    Raises
    ------
    ValueError
        With file, line and column, as far as there are any: if a cell is no number, a coordinate
        has no column, frames, rate or names lack, or commas may mean two things.
    """
    table = read_table(path)
    read = next(read for recognizes, read in _FORMS if recognizes(table))
    return read(table, zeros_missing=zeros_missing)


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
        raise ValueError(f"CSV cannot keep the marker name {(unfit or [''])[0]!r}")
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
