"""Heads as GLB files."""

from __future__ import annotations

import warnings
from pathlib import Path

from nodegraph import Format
from nodegraph_files.glb.buffers import MAGIC, UNIT, Accessors, split_glb
from nodegraph_files.glb.document import Document, entry_at, read_document
from nodegraph_files.glb.mesh import Placed, check_sizes, joined_parts, placed_meshes, read_mesh
from nodegraph_files.head import RawHead


def read_glb(path: Path) -> RawHead:
    """Read a head from a GLB file.

    It is made of the meshes with morph targets that the scene shows, in the order of the scene's
    tree, moved to where their nodes and skins hold them; of all meshes, if none has morph targets.
    Vertices are numbered through. Morph targets of one name are one, and those that the file does
    not name (``targetNames`` in the extras of the mesh) are ``morph_1``, ...; warnings count these
    and the meshes that are left out. What is at rest is the mesh without its morph targets; a
    warning says where the file would show it otherwise.

    Raises
    ------
    ValueError
        With the file, and the place in it: if it is damaged or no GLB file, keeps a part in another
        file, is compressed, shows no mesh, or its parts do not fit together.
    """
    try:
        text, binary = split_glb(path.read_bytes())
        document = read_document(text)
        return _head(document, Accessors(document, binary))
    except ValueError as error:
        raise ValueError(f"{path}: not a readable GLB head: {error}") from None


def _head(document: Document, accessors: Accessors) -> RawHead:
    placed = _of_the_head(document, placed_meshes(document, accessors))
    check_sizes([document.meshes[mesh.mesh] for mesh in placed], accessors)
    parts = [read_mesh(document.meshes[mesh.mesh], mesh, accessors) for mesh in placed]
    head = joined_parts(parts)
    if not len(head.faces):
        raise ValueError("it shows no mesh")
    if sum(len(part.marker_vertices) for part in parts) > len(head.marker_vertices):
        raise ValueError("two meshes name the same marker")
    extras = document.asset.extras
    return RawHead(
        vertices=head.vertices,
        faces=head.faces,
        morphs=head.morphs,
        unit=UNIT,
        unit_stated=isinstance(extras, dict) and extras.get("unit") == UNIT,
        marker_vertices=head.marker_vertices,
    )


def _of_the_head(document: Document, placed: list[Placed]) -> list[Placed]:
    meshes = {
        part.mesh: entry_at(document.meshes, part.mesh, "mesh", f"node {part.node}")
        for part in placed
    }
    moving = [part for part in placed if meshes[part.mesh].primitives[0].targets]
    parts = moving or placed
    rest = [meshes[part.mesh].name or f"mesh {part.mesh}" for part in placed if part not in parts]
    if rest:
        warnings.warn(
            f"{len(rest)} meshes without morph targets are left out: {', '.join(rest)}",
            stacklevel=4,
        )
    _tell_raised(document, parts)
    return parts


def _tell_raised(document: Document, parts: list[Placed]) -> None:
    """Warn of morph targets that the file shows from the start."""
    raised = 0
    for part in parts:
        node = document.nodes[part.node].weights if document.nodes else []
        raised += sum(weight != 0 for weight in node or document.meshes[part.mesh].weights)
    if raised:
        warnings.warn(
            f"{raised} morph targets have a weight from the start; the head at rest is without",
            stacklevel=5,
        )


FORMAT = Format(
    "GLB",
    RawHead,
    (".glb",),
    lambda path, *, is_folder: read_glb(path),
    lambda start: start.startswith(MAGIC),
)
