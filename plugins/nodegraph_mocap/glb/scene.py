"""Where the meshes of a glTF file stand, and how a skin holds their vertices.

Source: glTF 2.0 Specification, sections 3.5 (Concepts) and 3.7.3 (Skins), The Khronos Group.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.glb.accessors import Accessors
from nodegraph_mocap.glb.document import Document, Node, Primitive, found

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Placed:
    """A mesh in the scene: of which node, and the (4, 4) matrix of each joint or of the node."""

    mesh: int
    node: int
    matrices: NDArray[np.float64]
    skinned: bool = False


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
    places = dict(_tree(document))
    return [
        _placed(document, accessors, index, node.mesh, places)
        for index, node in ((index, document.nodes[index]) for index in places)
        if node.mesh is not None
    ]


def vertex_matrices(
    placed: Placed, primitive: Primitive, accessors: Accessors, where: str, count: int
) -> NDArray[np.float64]:
    """Return what takes a primitive's vertices to the scene: (4, 4), or (V, 4, 4) by its skin."""
    if not placed.skinned:
        return placed.matrices
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
        node = found(document.nodes, index, "node", "the scene")
        if index in seen:
            raise ValueError(f"node {index} is in the scene twice")
        seen.add(index)
        place = parent @ _own_place(node, index)
        yield index, place
        todo.extend((child, place) for child in reversed(node.children))


def _roots(document: Document) -> list[int]:
    if document.scenes:
        return found(document.scenes, document.scene, "scene", "the file").nodes
    below = {child for node in document.nodes for child in node.children}
    return [index for index in range(len(document.nodes)) if index not in below]


def _own_place(node: Node, index: int) -> NDArray[np.float64]:
    if node.matrix is not None:
        return np.array(node.matrix).reshape(4, 4).T
    place = np.eye(4)
    place[:3, :3] = _turned(node.rotation, index) * np.array(node.scale)
    place[:3, 3] = node.translation
    return place


def _turned(quaternion: tuple[float, float, float, float], index: int) -> NDArray[np.float64]:
    """Return the rotation matrix of a quaternion x, y, z, w."""
    length = float(np.linalg.norm(quaternion))
    if not length:
        raise ValueError(f"node {index}: its rotation is zero")
    x, y, z, w = np.array(quaternion) / length
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + 2 * w * across + 2 * across @ across)


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
    skin = found(document.skins, node.skin, "skin", f"node {index}")
    absent = [joint for joint in skin.joints if joint not in places]
    if absent:
        raise ValueError(f"{where}: its joint, node {absent[0]}, is not in the scene")
    # by the specification the joints alone hold a skinned mesh, and not its own node
    joints = np.array([places[joint] for joint in skin.joints])
    if skin.inverse_bind_matrices is not None:
        stored = accessors.numbers(skin.inverse_bind_matrices, where, kind="MAT4")
        if len(stored) < len(joints):
            raise ValueError(f"{where}: {len(stored)} matrices for {len(joints)} joints")
        joints = joints @ stored[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
    return Placed(mesh, index, joints, skinned=True)
