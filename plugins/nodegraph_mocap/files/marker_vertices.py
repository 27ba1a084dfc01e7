"""Which vertex of a mesh each marker sits on, as a table of text."""

from __future__ import annotations

import csv
from pathlib import Path

from nodegraph_mocap.text.cells import text_lines

_HEADER = ["marker", "vertex"]


def read_marker_vertices(path: Path, vertices: int) -> dict[str, int]:
    """Read which vertex each marker sits on.

    The table has the header ``marker,vertex`` and a row per marker; vertices count from 0.

    Parameters
    ----------
    path
        The file.
    vertices
        How many vertices the mesh has.

    Returns
    -------
    dict of marker to vertex
        In the order of the rows.

    Raises
    ------
    ValueError
        With file and line, if a row is not of that form, a marker is there twice, or the mesh has
        no such vertex.
    """
    rows = csv.reader(text_lines(path), strict=True)
    found: dict[str, int] = {}
    try:
        header = [cell.strip().lower() for cell in next(rows, [])]
        if header != _HEADER:
            raise ValueError(f"the header must be {','.join(_HEADER)}, not {','.join(header)!r}")
        for row in rows:
            cells = [cell.strip() for cell in row]
            if any(cells):
                _add(found, cells, vertices)
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}:{rows.line_num}: {error}") from None
    return found


def _add(found: dict[str, int], cells: list[str], vertices: int) -> None:
    if len(cells) != 2 or not cells[0]:
        raise ValueError(f"a marker and its vertex are needed, not {','.join(cells)!r}")
    marker, written = cells
    if marker in found:
        raise ValueError(f"marker {marker!r} again")
    if not (written.isascii() and written.isdecimal()):
        raise ValueError(f"{written!r} is not the number of a vertex")
    vertex = int(written)
    if vertex >= vertices:
        raise ValueError(f"marker {marker!r}: no vertex {vertex}; the mesh has {vertices}, from 0")
    found[marker] = vertex
