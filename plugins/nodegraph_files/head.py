"""Read a head, whatever its file form."""

from __future__ import annotations

import csv
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Literal

from nodegraph import InputFile, node
from nodegraph_files.glb.buffers import MAGIC
from nodegraph_files.glb.reading import read_glb
from nodegraph_files.obj import read_obj
from nodegraph_files.paths import find_file
from nodegraph_files.raw_head import RawHead
from nodegraph_files.text.table import text_lines
from nodegraph_files.units import MILLIMETRES
from nodegraph_mocap.head import Head

_LEAST, _MOST = 100.0, 500.0
"""Millimetres that a head, a face or a bust may measure, the longest way along an axis."""

_USUAL = ("m", "cm", "mm")
"""At most one of them gives a plausible size, as they lie further apart than its bounds."""


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
    unit = assumed
    if not (stated or _plausible(extent, assumed)):
        unit = next((one for one in _USUAL if _plausible(extent, one)), assumed)
    size = f"{extent * MILLIMETRES[unit]:.4g} mm"
    if not _plausible(extent, unit):
        _warn(path, f"the mesh is {size} long in {unit}, which no head is; set `unit`?")
    elif unit != assumed:
        wrong = f"{extent * MILLIMETRES[assumed]:.4g} mm"
        _warn(path, f"the head would be {wrong} long in {assumed}; {unit} is taken, giving {size}")
    return unit


def _plausible(extent: float, unit: str) -> bool:
    return _LEAST <= extent * MILLIMETRES[unit] <= _MOST


def _warn(path: Path, said: str) -> None:
    warnings.warn(f"{path}: {said}", stacklevel=5)


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


_NEUTRAL = "neutral.obj"
_HEADS = ("head.glb", _NEUTRAL, "head.obj")
_MARKER_VERTICES = ("marker_vertices.csv",)


@node("read.head")
def read_head(
    *,
    path: InputFile,
    marker_vertices: InputFile | None = None,
    unit: Literal["auto", "m", "cm", "mm", "in"] = "auto",
) -> Head:
    """Read a head with its morph targets: a GLB file, or OBJ files.

    Parameters
    ----------
    path
        A GLB file; an OBJ file, a head without morph targets; or a folder that holds ``head.glb``,
        or ``neutral.obj`` and an OBJ file per morph target, named as it is and with the same
        vertices and faces.
    marker_vertices
        A table ``marker,vertex`` (CSV), vertices counted from 0. By default
        ``marker_vertices.csv`` of the folder, or what a GLB file says itself, or no markers.
    unit
        Of length in the file. By default metres for GLB, as glTF has it, and millimetres for OBJ;
        but if the head would then be no 100 to 500 mm long, and is so in metres, centimetres or
        millimetres, then these, with a warning. A GLB file by this package is sure to be in metres.

    Returns
    -------
    Head
        In millimetres, in the axes of the file.

    Raises
    ------
    ValueError
        If a file cannot be read, or names a vertex that is not there.
    """
    file = find_file(path, _HEADS)
    raw = _read(file, with_shapes=Path(path) != file)
    table = _table(Path(path), file, marker_vertices)
    if table is not None:
        raw = replace(raw, marker_vertices=read_marker_vertices(table, len(raw.vertices)))
    try:
        return raw.head(MILLIMETRES[_unit(file, raw, unit)])
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None


def _read(file: Path, *, with_shapes: bool) -> RawHead:
    with file.open("rb") as opened:
        start = opened.read(len(MAGIC))
    suffix = file.suffix.lower()
    if start == MAGIC or suffix == ".glb":
        return read_glb(file)
    if suffix != ".obj":
        raise ValueError(f"{file}: neither GLB nor OBJ")
    others = sorted(one for one in file.parent.glob("*.obj") if one != file)
    return read_obj(file, tuple(others) if with_shapes and file.name == _NEUTRAL else ())


def _table(path: Path, file: Path, given: Path | None) -> Path | None:
    """Return the table of marker vertices; the one beside a file only if its folder was named."""
    if given is not None:
        return find_file(given, _MARKER_VERTICES)
    beside = file.parent / _MARKER_VERTICES[0]
    return beside if path != file and beside.is_file() else None


def _unit(file: Path, raw: RawHead, given: str) -> str:
    if given != "auto":
        return unit_of_mesh(file, raw.extent, assumed=given, stated=True)
    unit = unit_of_mesh(file, raw.extent, assumed=raw.unit, stated=raw.unit_stated)
    if file.suffix.lower() == ".obj":
        warnings.warn(f"{file}: OBJ tells no unit of length; {unit} is taken", stacklevel=3)
    return unit
