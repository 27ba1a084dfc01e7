"""Heads as OBJ files: one at rest, and one per shape with the same faces.

Source: Alias|Wavefront, Object Files (.obj), appendix B1 of the Advanced Visualizer's manual.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Format, quoted
from nodegraph_files.head import NEUTRAL, RawHead
from nodegraph_files.text.table import cell_numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray

UNIT = "mm"
"""Assumed, because an OBJ file states none."""

_CORNER = re.compile(r"(-?[0-9]{1,18})(/.*)?")


def read_obj(path: Path, shapes: tuple[Path, ...] = ()) -> RawHead:
    """Read a head from OBJ files.

    Polygons become fans of triangles. All vertices count, also those of no face. Texture
    coordinates, normals, materials, lines and groups are not read.

    Parameters
    ----------
    path
        The head at rest.
    shapes
        The head with one shape each at weight 1; the file's name, without suffix, is the shape's.

    Raises
    ------
    ValueError
        With file and line, if a vertex is not three numbers, or a face names what is not there; or
        if a shape has other vertices or faces than the head at rest.
    """
    vertices, faces = _mesh(path)
    morphs = {}
    for shape in shapes:
        moved, its_faces = _mesh(shape)
        if len(moved) != len(vertices):
            raise ValueError(
                f"{shape}: has {len(moved)} vertices, but {path.name} has {len(vertices)}"
            )
        if not np.array_equal(its_faces, faces):
            raise ValueError(f"{shape}: its faces are not those of {path.name}")
        morphs[shape.stem] = moved - vertices
    return RawHead(vertices=vertices, faces=faces, morphs=morphs, unit=UNIT)


def _mesh(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return (V, 3) vertices in the file's unit and (F, 3) triangles."""
    vertices: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    lines: list[int] = []
    for line, words in _statements(path):
        if words[0] == "v":
            vertices.append(_vertex(path, line, words[1:]))
        elif words[0] == "f":
            corners = [_corner(path, line, word, len(vertices)) for word in words[1:]]
            if len(corners) < 3:
                raise ValueError(f"{path}:{line}: a face has three corners at least")
            triangles += [(corners[0], *edge) for edge in pairwise(corners[1:])]
            lines += [line] * (len(corners) - 2)
    if not triangles:
        raise ValueError(f"{path}: no mesh: it has {len(vertices)} vertices and no faces")
    faces = np.array(triangles)
    if faces.max() >= len(vertices):
        # known only now, as a face may stand before its vertices
        row, corner = np.unravel_index(np.argmax(faces), faces.shape)
        raise ValueError(
            f"{path}:{lines[row]}: a face names vertex {faces[row, corner] + 1}; there are "
            f"{len(vertices)}"
        )
    return np.array(vertices), faces


def _statements(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the words of each statement, without comment, and the line where it ends."""
    # names and comments may be of any encoding; numbers are ASCII in all of them
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    words: list[str] = []
    for number, line in enumerate(text.split("\n"), 1):
        plain = line.partition("#")[0].rstrip()
        words += plain.removesuffix("\\").split()
        if words and not plain.endswith("\\"):
            yield number, words
            words = []


def _vertex(path: Path, line: int, words: list[str]) -> list[float]:
    # after x, y, z some programs write a weight or a colour
    numbers = cell_numbers(path, line, words[:3], columns=range(2, 2 + len(words[:3])))
    if len(numbers) < 3 or not all(map(math.isfinite, numbers)):
        raise ValueError(f"{path}:{line}: a vertex has three finite numbers, not {words[:3]}")
    return numbers


def _corner(path: Path, line: int, word: str, vertices: int) -> int:
    """Return the vertex of ``vertex/texture/normal``, counted from 0; negative ones count back."""
    named = _CORNER.fullmatch(word)
    number = int(named[1]) if named else 0
    if not number:
        raise ValueError(f"{path}:{line}: {quoted(word)} names no vertex")
    if -number > vertices:
        raise ValueError(f"{path}:{line}: a face names vertex {number} of {vertices} so far")
    return number - 1 if number > 0 else vertices + number


def _read(path: Path, *, is_folder: bool) -> RawHead:
    """Read a head, with the morph targets beside it if the user named its folder."""
    targets = sorted(path.parent.glob("*.obj")) if is_folder and path.name == NEUTRAL else []
    return read_obj(path, tuple(target for target in targets if target != path))


FORMAT = Format("OBJ", RawHead, (".obj",), _read)
