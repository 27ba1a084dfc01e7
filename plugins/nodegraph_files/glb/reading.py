"""Heads out of GLB files: the meshes that the scene shows, with their morph targets.

Source: glTF 2.0 Specification, sections 3.5 (Scenes) and 3.7 (Meshes), The Khronos Group.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Format, listed, quoted
from nodegraph_files.glb.buffers import (
    MAGIC,
    MARKER_VERTICES,
    TARGET_NAMES,
    UNIT,
    Accessors,
    opened_glb,
)
from nodegraph_files.glb.document import (
    Document,
    Mesh,
    Primitive,
    SceneNode,
    entry_at,
)
from nodegraph_files.head import RawHead
from nodegraph_mocap.checks import distinct

if TYPE_CHECKING:
    from numpy.typing import NDArray

_TRIANGLES, _STRIP, _FAN = 4, 5, 6


@dataclass(frozen=True)
class Placed:
    """A mesh in the scene: of which node, and the (4, 4) matrix of each joint or of the node."""

    mesh: int
    node: int
    matrices: NDArray[np.float64]
    skinned: bool = False


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
        document, accessors = opened_glb(path)
        return head_of(document, meshes_of_head(document, accessors), accessors)
    except ValueError as error:
        raise ValueError(f"{path}: not a readable GLB head: {error}") from None


def head_of(document: Document, placed: list[Placed], accessors: Accessors) -> RawHead:
    """Return the head that meshes of a scene are, at rest.

    Raises
    ------
    ValueError
        As `read_glb` does.
    """
    parts = [read_mesh(document.meshes[mesh.mesh], mesh, accessors) for mesh in placed]
    names = {name for part in parts for name in part.morphs}
    accessors.charge(len(names) * sum(part.vertices.size for part in parts), len(names))
    head = joined_parts(parts)
    if not len(head.faces):
        raise ValueError("it shows no mesh")
    if sum(len(part.marker_vertices) for part in parts) > len(head.marker_vertices):
        raise ValueError("two meshes name the same marker")
    extras = document.asset.extras
    is_stated = isinstance(extras, dict) and extras.get("unit") == UNIT
    return replace(head, unit_stated=is_stated)


def meshes_of_head(document: Document, accessors: Accessors) -> list[Placed]:
    """Return the meshes with morph targets that the scene shows; all, if none has any.

    Raises
    ------
    ValueError
        If nodes form no tree, or name what is not there.
    """
    placed = placed_meshes(document, accessors)
    meshes = {
        part.mesh: entry_at(document.meshes, part.mesh, "mesh", f"node {part.node}")
        for part in placed
    }
    moving = [part for part in placed if meshes[part.mesh].primitives[0].targets]
    parts = moving or placed
    if len(parts) < len(placed):
        still = [part.mesh for part in placed if not meshes[part.mesh].primitives[0].targets]
        names = [meshes[mesh].name or f"mesh {mesh}" for mesh in still]
        warnings.warn(
            f"{len(names)} meshes without morph targets are left out: {listed(names)}",
            stacklevel=4,
        )
    _warn_raised(document, parts)
    return parts


def _warn_raised(document: Document, parts: list[Placed]) -> None:
    """Warn of morph targets that the file shows from the start."""
    of_mesh = [sum(weight != 0 for weight in mesh.weights) for mesh in document.meshes]
    raised = 0
    for part in parts:
        node = document.nodes[part.node].weights if document.nodes else []
        raised += sum(weight != 0 for weight in node) if node else of_mesh[part.mesh]
    if raised:
        warnings.warn(
            f"{raised} morph targets have a weight from the start; the head at rest is without",
            stacklevel=5,
        )


def placed_meshes(document: Document, accessors: Accessors) -> list[Placed]:
    """Return the meshes that the scene shows, in the order of its tree.

    A file without nodes shows each mesh as it is.

    Raises
    ------
    ValueError
        If nodes form no tree, or name what is not there.
    """
    if not document.nodes:
        return [Placed(index, 0, np.eye(4)) for index in range(len(document.meshes))]
    accessors.charge(16 * len(document.nodes), len(document.nodes))
    places = dict(_tree(document))
    return [
        _placed(document, accessors, index, node.mesh, places)
        for index, node in ((index, document.nodes[index]) for index in places)
        if node.mesh is not None
    ]


def vertex_matrices(
    placed: Placed, primitive: Primitive, accessors: Accessors, where: str, count: int
) -> NDArray[np.float64]:
    """Return what takes a primitive's vertices to the scene: (4, 4), or (V, 4, 4) by its skin.

    Raises
    ------
    ValueError
        If joints have no weights or are not there, or a vertex is bound to none.
    """
    if not placed.skinned:
        return placed.matrices
    accessors.charge(16 * count)
    held, total = np.zeros((count, 4, 4)), np.zeros(count)
    for name in primitive.attributes:
        if not name.startswith("JOINTS_"):
            continue
        pulls = name.replace("JOINTS", "WEIGHTS")
        if pulls not in primitive.attributes:
            raise ValueError(f"{where}: has {name}, but no {pulls}")
        at = f"{where}.{name}"
        joints = accessors.integers(primitive.attributes[name], at, kind="VEC4", count=count)
        weights = accessors.numbers(primitive.attributes[pulls], at, kind="VEC4", count=count)
        if joints.max() >= len(placed.matrices):
            raise ValueError(f"{at}: names joint {joints.max()} of {len(placed.matrices)}")
        for column in range(4):
            held += weights[:, column, None, None] * placed.matrices[joints[:, column]]
        total += weights.sum(axis=1)
    if not total.all():
        raise ValueError(f"{where}: the skin does not hold vertex {int(np.argmin(total))}")
    return np.asarray(held / total[:, None, None])


def _tree(document: Document) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Yield each node of the scene and its place."""
    todo = [(index, np.eye(4)) for index in reversed(_roots(document))]
    seen: set[int] = set()
    while todo:
        index, parent = todo.pop()
        node = entry_at(document.nodes, index, "node", "the scene")
        if index in seen:
            raise ValueError(f"node {index} is in the scene twice")
        seen.add(index)
        place = parent @ places_of(node, index)[0]
        yield index, place
        todo.extend((child, place) for child in reversed(node.children))


def _roots(document: Document) -> list[int]:
    if document.scenes:
        return entry_at(document.scenes, document.scene, "scene", "the file").nodes
    below = {child for node in document.nodes for child in node.children}
    return [index for index in range(len(document.nodes)) if index not in below]


def places_of(
    node: SceneNode, index: int, parts: Mapping[str, NDArray[np.float64]] = {}, frames: int = 1
) -> NDArray[np.float64]:
    """Return (T, 4, 4): from a node to the one above it, of which some parts have T values."""
    from scipy.spatial.transform import Rotation

    if node.matrix is not None and not parts:
        return np.tile(np.array(node.matrix).reshape(4, 4).T, (frames, 1, 1))
    quaternions = np.broadcast_to(parts.get("rotation", np.array(node.rotation)), (frames, 4))
    if not np.linalg.norm(quaternions, axis=1).all():
        raise ValueError(f"node {index}: its rotation is zero")
    places = np.tile(np.eye(4), (frames, 1, 1))
    scales = np.broadcast_to(parts.get("scale", np.array(node.scale)), (frames, 3))
    places[:, :3, :3] = Rotation.from_quat(quaternions).as_matrix() * scales[:, np.newaxis]
    places[:, :3, 3] = parts.get("translation", np.array(node.translation))
    return places


def _placed(
    document: Document,
    accessors: Accessors,
    index: int,
    mesh: int,
    places: Mapping[int, NDArray[np.float64]],
) -> Placed:
    node = document.nodes[index]
    if node.skin is None:
        return Placed(mesh, index, places[index])
    where = f"skin {node.skin}"
    skin = entry_at(document.skins, node.skin, "skin", f"node {index}")
    absent = [joint for joint in skin.joints if joint not in places]
    if absent:
        raise ValueError(f"{where}: its joint, node {absent[0]}, is not in the scene")
    accessors.charge(16 * len(skin.joints))
    # by the specification the joints alone hold a skinned mesh, and not its own node
    joints = np.array([places[joint] for joint in skin.joints])
    if skin.inverse_bind_matrices is not None:
        stored = accessors.numbers(skin.inverse_bind_matrices, where, kind="MAT4")
        if len(stored) < len(joints):
            raise ValueError(f"{where}: {len(stored)} matrices for {len(joints)} joints")
        joints = joints @ stored[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
    return Placed(mesh, index, joints, skinned=True)


def read_mesh(mesh: Mesh, placed: Placed, accessors: Accessors) -> RawHead:
    """Return a mesh as it stands in the scene.

    Primitives that name the same vertices share them; others follow one another. Points and lines
    are left out, with a warning.

    Raises
    ------
    ValueError
        If something that the mesh names is not there, or of another size or type.
    """
    where = f"mesh {placed.mesh}" + (f" ({mesh.name})" if mesh.name else "")
    accessors.charge(0, len(mesh.primitives[0].targets))
    names = target_names(mesh, where)
    parts: dict[object, tuple[RawHead, list[NDArray[np.int64]]]] = {}
    for number, primitive in enumerate(mesh.primitives):
        at = f"{where}, primitive {number}"
        accessors.charge(0)
        if primitive.mode < _TRIANGLES:
            warnings.warn(f"{at}: points or lines, which are left out", stacklevel=2)
            continue
        key = (*primitive.attributes.items(), *map(str, primitive.targets))
        if key not in parts:
            parts[key] = _vertices(primitive, names, placed, accessors, at), []
        part, faces = parts[key]
        faces.append(_faces(primitive, accessors, at, len(part.vertices)))
    joined = joined_parts(
        [replace(part, faces=np.concatenate(faces)) for part, faces in parts.values()]
    )
    markers = _markers(mesh, where, len(joined.vertices))
    accessors.charge(0, len(markers))
    turned = joined.faces[:, ::-1] if _mirrored(placed) else joined.faces
    return replace(joined, faces=turned, marker_vertices=markers)


def joined_parts(parts: list[RawHead]) -> RawHead:
    """Return parts as one; a morph target that a part lacks leaves its vertices where they are."""
    vertices = np.concatenate([np.zeros((0, 3)), *(part.vertices for part in parts)])
    firsts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    names = list(dict.fromkeys(name for part in parts for name in part.morphs))
    morphs = {name: np.zeros_like(vertices) for name in names}
    markers: dict[str, int] = {}
    for part, first in zip(parts, firsts, strict=False):
        for name, offsets in part.morphs.items():
            morphs[name][first : first + len(offsets)] = offsets
        for marker, vertex in part.marker_vertices.items():
            markers[marker] = int(vertex + first)
    faces = [part.faces + first for part, first in zip(parts, firsts, strict=False)]
    together = np.concatenate([np.zeros((0, 3), np.int64), *faces])
    return RawHead(vertices, together, morphs, UNIT, marker_vertices=markers)


def _vertices(
    primitive: Primitive, names: tuple[str, ...], placed: Placed, accessors: Accessors, where: str
) -> RawHead:
    if "POSITION" not in primitive.attributes:
        raise ValueError(f"{where}: its vertices have no POSITION")
    if len(primitive.targets) != len(names):
        raise ValueError(
            f"{where}: {len(primitive.targets)} morph targets where the mesh has {len(names)}"
        )
    rest = accessors.numbers(primitive.attributes["POSITION"], where, kind="VEC3")
    count = len(rest)
    matrices = vertex_matrices(placed, primitive, accessors, where, count)
    linear, shift = matrices[..., :3, :3], matrices[..., :3, 3]
    morphs = {}
    for name, target in zip(names, primitive.targets, strict=True):
        if "POSITION" in target:
            at = f"{where}, morph target {quoted(name)}"
            offsets = accessors.numbers(target["POSITION"], at, kind="VEC3", count=count)
        else:
            accessors.charge(rest.size)
            offsets = np.zeros_like(rest)
        morphs[name] = _turned(linear, offsets)
    return RawHead(_turned(linear, rest) + shift, np.zeros((0, 3), np.int64), morphs, UNIT)


def _turned(linear: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.einsum("...ij,...j->...i", linear, vectors))


def _mirrored(placed: Placed) -> bool:
    linear = placed.matrices[..., :3, :3].reshape(-1, 3, 3)
    return bool(np.linalg.det(linear).mean() < 0)


def _faces(
    primitive: Primitive, accessors: Accessors, where: str, vertices: int
) -> NDArray[np.int64]:
    if primitive.indices is None:
        accessors.charge(vertices)
        order = np.arange(vertices)
    else:
        order = accessors.integers(primitive.indices, where)[:, 0]
        if order.max() >= vertices:
            raise ValueError(f"{where}: a face names vertex {order.max()} of {vertices}")
    if primitive.mode == _STRIP:
        windows = np.stack([order[:-2], order[1:-1], order[2:]], axis=1)
        windows[1::2] = windows[1::2, [0, 2, 1]]
        return windows
    if primitive.mode == _FAN:
        return np.stack([order[1:-1], order[2:], np.full(len(order[2:]), order[0])], axis=1)
    if len(order) % 3:
        raise ValueError(f"{where}: {len(order)} corners make no triangles")
    return order.reshape(-1, 3)


def target_names(mesh: Mesh, where: str) -> tuple[str, ...]:
    """Return the names of a mesh's morph targets; those that have none are numbered.

    Raises
    ------
    ValueError
        If there are others in number, or one is listed twice.
    """
    count = len(mesh.primitives[0].targets)
    names = mesh.extras.get(TARGET_NAMES) if isinstance(mesh.extras, dict) else None
    if names is None:
        if count:
            warnings.warn(f"{where}: its {count} morph targets have no names", stacklevel=3)
        return tuple(f"morph_{number}" for number in range(1, count + 1))
    if not isinstance(names, list) or not all(isinstance(name, str) and name for name in names):
        raise ValueError(f"{where}: extras.{TARGET_NAMES} must be a list of names")
    if len(names) != count:
        raise ValueError(f"{where}: {len(names)} names for {count} morph targets")
    return distinct(f"{where}, morph targets", names)


def _markers(mesh: Mesh, where: str, vertices: int) -> Mapping[str, int]:
    markers = mesh.extras.get(MARKER_VERTICES, {}) if isinstance(mesh.extras, dict) else {}
    good = isinstance(markers, dict) and all(
        type(vertex) is int and 0 <= vertex < vertices for vertex in markers.values()
    )
    if not good:
        raise ValueError(
            f"{where}: extras.{MARKER_VERTICES} must give each marker one of {vertices} vertices"
        )
    return dict(markers)


FORMAT = Format(
    "GLB",
    RawHead,
    (".glb",),
    lambda path, *, is_folder: read_glb(path),
    lambda start: start.startswith(MAGIC),
)
