"""Heads as their files have them, in a unit that may have to be guessed, and their markers."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import quoted
from nodegraph_files.units import HEAD, MILLIMETRES
from nodegraph_mocap.head import Head

if TYPE_CHECKING:
    from numpy.typing import NDArray

NEUTRAL = "neutral.obj"
"""The head at rest in a folder with an OBJ file per morph target."""

_COLUMNS = ["marker", "vertex"]


@dataclass(frozen=True)
class RawHead:
    """A head as a reader returns it.

    Attributes
    ----------
    vertices : (V, 3) array of float64
    faces : (F, 3) array of int64
    morphs : mapping of name to (V, 3) array of float64
        Offsets of the vertices at weight 1.
    unit : str
        Unit of length.
    unit_stated : bool
        Whether this file states the unit, so that it is not guessed.
    marker_vertices : mapping of marker to vertex
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    morphs: Mapping[str, NDArray[np.float64]]
    unit: str
    unit_stated: bool = False
    marker_vertices: Mapping[str, int] = field(default_factory=dict)

    @property
    def extent(self) -> float:
        """The longest side, along an axis."""
        return float(np.ptp(self.vertices, axis=0).max())

    def head(self, millimetres: float) -> Head:
        """Return the head in millimetres, given the millimetres of its unit."""
        offsets = list(self.morphs.values()) or np.zeros((0, *self.vertices.shape))
        return Head(
            vertices=self.vertices * millimetres,
            faces=self.faces,
            morphs=np.asarray(offsets) * millimetres,
            names=tuple(self.morphs),
            markers=tuple(self.marker_vertices),
            marker_vertices=np.array(list(self.marker_vertices.values()), dtype=np.int64),
        )


def unit_of_mesh(path: Path, extent: float, *, assumed: str, stated: bool) -> str:
    """Return the unit in which a head's mesh was most likely written.

    That is the one assumed if it is stated or gives a plausible size, or else the one of metres,
    centimetres and millimetres that does; if none does, the one assumed. A warning says what was
    taken, where the assumed one is neither stated nor plausible, and where the size is not
    plausible at all.

    Parameters
    ----------
    path
        The file, for the warning.
    extent
        The mesh's longest side, along an axis, in its own unit.
    assumed
        The unit that the file's form, or somebody, says.
    stated
        Whether this file, or the user, says so and not only the form: then nothing is guessed.
    """
    unit = assumed if stated else HEAD.unit_of(extent, assumed)
    size = f"{extent * MILLIMETRES[unit]:.4g} mm"
    if not HEAD.includes(extent, unit):
        _warn(path, f"the mesh is {size} long in {unit}, which no head is; set `unit`?")
    elif unit != assumed:
        wrong = f"{extent:.4g} {assumed}"
        _warn(path, f"the head would be {wrong} long; {unit} is taken, giving {size}")
    return unit


def _warn(path: Path, message: str) -> None:
    warnings.warn(f"{path}: {message}", stacklevel=5)


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
    import csv

    from nodegraph_files.text.table import text_lines

    rows = csv.reader(text_lines(path), strict=True)
    vertex_of: dict[str, int] = {}
    try:
        header = [cell.strip().lower() for cell in next(rows, [])]
        if header != _COLUMNS:
            raise ValueError(
                f"the header must be {','.join(_COLUMNS)}, not {quoted(','.join(header))}"
            )
        for row in rows:
            cells = [cell.strip() for cell in row]
            if any(cells):
                _add(vertex_of, cells, vertices)
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{path}:{rows.line_num}: {error}") from None
    return vertex_of


def _add(vertex_of: dict[str, int], cells: list[str], vertices: int) -> None:
    if len(cells) != 2 or not cells[0]:
        raise ValueError(f"a marker and its vertex are needed, not {quoted(','.join(cells))}")
    marker, written = cells
    if marker in vertex_of:
        raise ValueError(f"marker {quoted(marker)} again")
    if not (written.isascii() and written.isdecimal()):
        raise ValueError(f"{quoted(written)} is not the number of a vertex")
    vertex = int(written)
    if vertex >= vertices:
        raise ValueError(
            f"marker {quoted(marker)}: no vertex {vertex}; the mesh has {vertices}, from 0"
        )
    vertex_of[marker] = vertex
