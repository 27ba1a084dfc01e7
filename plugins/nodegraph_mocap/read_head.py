"""Read a head, whatever its file form."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import Literal

from nodegraph import InputFile, node
from nodegraph_mocap.files.marker_vertices import read_marker_vertices
from nodegraph_mocap.files.mesh_size import unit_of_mesh
from nodegraph_mocap.files.obj import read_obj
from nodegraph_mocap.files.raw_head import RawHead
from nodegraph_mocap.glb.container import MAGIC
from nodegraph_mocap.glb.reading import read_glb
from nodegraph_mocap.head import Head
from nodegraph_mocap.paths import find_file
from nodegraph_mocap.units import MILLIMETRES

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
