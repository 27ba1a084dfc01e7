"""Heads and animations as GLB files.

Source: glTF 2.0 Specification, sections 3.7.2 (Meshes) and 3.11 (Animations), The Khronos Group.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph_files.glb.buffers import MARKER_VERTICES, TARGET_NAMES, UNIT, GlbBuffer, joined_glb
from nodegraph_mocap.animation import Animation
from nodegraph_mocap.head import Head

if TYPE_CHECKING:
    from numpy.typing import NDArray

_AHEAD = np.array([0.0, 0.0, 1.0])
_METRES = 0.001
_MATERIAL = {
    "name": "skin",
    "pbrMetallicRoughness": {
        "baseColorFactor": [0.8, 0.8, 0.8, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 0.8,
    },
}
"""glTF's own is bare metal, which is black where nothing is around to be reflected."""


def held_weights(animation: Animation) -> NDArray[np.float64]:
    """Return (T, K) weights of the head's morph targets; a missing one repeats the last known.

    Before the first known weight it is the first, and 0 for a shape without any. A warning counts
    them.
    """
    weights = animation.morph_weights
    known = ~np.isnan(weights)
    if known.all():
        return weights
    frames = np.arange(len(weights))[:, None]
    last = np.maximum.accumulate(np.where(known, frames, -1), axis=0)
    source = np.where(last < 0, known.argmax(axis=0), last)
    held = np.nan_to_num(np.take_along_axis(weights, source, axis=0))
    never = np.asarray(~known.any(axis=0))
    _warn(animation, known, never)
    return held


def quaternions(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (T, 4) quaternions x, y, z, w of (T, 3, 3) rotations.

    Of the two that stand for one rotation it is the one nearer to the frame before, so that a
    player which blends frames takes the short way.

    Raises
    ------
    ValueError
        If one is a reflection, with its frame.
    """
    from scipy.spatial.transform import Rotation

    reflected = np.linalg.det(rotations) < 0
    if reflected.any():
        frame = int(np.argmax(reflected))
        raise ValueError(
            f"head motion: frame {frame} is a reflection ({np.count_nonzero(reflected)} such "
            "frames), and a GLB file holds rotations only"
        )
    rotated = Rotation.from_matrix(rotations).as_quat()
    nearer = np.where(np.einsum("ti,ti->t", rotated[1:], rotated[:-1]) < 0, -1.0, 1.0)
    return np.asarray(rotated * np.cumprod([1.0, *nearer])[:, None])


def _warn(animation: Animation, known: NDArray[np.bool_], never: NDArray[np.bool_]) -> None:
    frame, shape = (int(index) for index in np.argwhere(~known)[0])
    names = [name for name, absent in zip(animation.head.names, never, strict=True) if absent]
    nowhere = f"; {', '.join(names)} have none at all and stay 0" if names else ""
    warnings.warn(
        f"{np.count_nonzero(~known)} weights in {np.count_nonzero(~known.all(axis=1))} frames are "
        f"missing, and repeat the last known one, or the first that follows; the earliest is "
        f"{animation.head.names[shape]!r} in frame {frame}{nowhere}",
        stacklevel=4,
    )


def head_bytes(head: Head) -> bytes:
    """Return a head as the bytes of a GLB file.

    In metres and single precision: read back, a coordinate differs by less than 1e-7 of itself.
    The axes stay, and glTF's are x to the face's left, y up, z ahead. Extras of the mesh name the
    morph targets (``targetNames``) and the vertex of each marker (``markerVertices``). For smooth
    shading there are normals, and offsets of them per morph target: exact where one target has
    weight 1, and a guess where several are mixed. The material is a dull light grey.

    Raises
    ------
    ValueError
        If the head has no faces, or is too large for single precision.
    """
    return _written(head, GlbBuffer(), [])


def animation_bytes(animation: Animation) -> bytes:
    """Return an animation as the bytes of a GLB file: the head, see `head_bytes`, and its motion.

    Weights, translation (metres), rotation and scale have a key per frame, from 0 s on, with
    linear interpolation. A missing weight repeats the last known one, with a warning.

    Raises
    ------
    ValueError
        If there are no frames, or one of them is a reflection; or as `head_bytes` does.
    """
    if not animation.frames:
        raise ValueError("the animation has no frames")
    buffer = GlbBuffer()
    seconds = np.arange(animation.frames) / animation.rate
    clock = buffer.keys(seconds[:, None], "times", bounds=True)
    tracks = [(path, buffer.keys(values, path)) for path, values in _tracks(animation).items()]
    motion = {
        "channels": [
            {"sampler": number, "target": {"node": 0, "path": path}}
            for number, (path, _) in enumerate(tracks)
        ],
        "samplers": [
            {"input": clock, "interpolation": "LINEAR", "output": output} for _, output in tracks
        ],
    }
    return _written(animation.head, buffer, [motion] if tracks else [])


def _tracks(animation: Animation) -> dict[str, NDArray[np.float64]]:
    """Return the animated properties of the head's node, by their names in glTF."""
    tracks: dict[str, NDArray[np.float64]] = {}
    if animation.head.names:
        tracks["weights"] = held_weights(animation).reshape(-1, 1)
    motion = animation.head_motion
    if motion is not None:
        tracks["translation"] = motion.translations * _METRES
        tracks["rotation"] = quaternions(motion.rotations)
        tracks["scale"] = np.repeat(motion.scales[:, None], 3, axis=1)
    return tracks


def _written(head: Head, buffer: GlbBuffer, animations: Sequence[Mapping[str, object]]) -> bytes:
    document = {
        "asset": {"version": "2.0", "generator": "nodegraph", "extras": {"unit": UNIT}},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "head", "mesh": 0}],
        "meshes": [_mesh(head, buffer)],
        "materials": [_MATERIAL],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.content)}],
    }
    return joined_glb(document | ({"animations": animations} if animations else {}), buffer.content)


def _mesh(head: Head, buffer: GlbBuffer) -> dict[str, object]:
    if not len(head.faces):
        raise ValueError("the head has no faces")
    primitive: dict[str, object] = {
        "attributes": {"POSITION": buffer.vertices(head.vertices * _METRES, "vertices")},
        "indices": buffer.corners(head.faces),
        "material": 0,
    }
    mesh: dict[str, object] = {"name": "head", "primitives": [primitive]}
    vertices = [int(vertex) for vertex in head.marker_vertices]
    extras: dict[str, object] = {MARKER_VERTICES: dict(zip(head.markers, vertices, strict=True))}
    if head.names:
        primitive["targets"] = [
            {"POSITION": buffer.vertices(offsets * _METRES, f"morph target {name!r}")}
            for name, offsets in zip(head.names, head.morphs, strict=True)
        ]
        mesh["weights"] = [0.0] * len(head.names)
        extras[TARGET_NAMES] = list(head.names)
    _add_normals(primitive, head, buffer)
    return mesh | {"extras": extras}


def _add_normals(primitive: dict[str, Any], head: Head, buffer: GlbBuffer) -> None:
    """Add normals of the mesh as it is stored, so that a head which was read writes the same."""
    at_rest = _stored(head.vertices)
    normals = vertex_normals(at_rest, head.faces)
    primitive["attributes"]["NORMAL"] = buffer.directions(normals, "normals")
    for target, offsets in zip(primitive.get("targets", ()), head.morphs, strict=True):
        posed = vertex_normals(at_rest + _stored(offsets), head.faces, otherwise=normals)
        target["NORMAL"] = buffer.directions(posed - normals, "normals")


def _stored(lengths: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return millimetres as the metres that a reader finds."""
    return (lengths * _METRES).astype(np.float32).astype(np.float64)


def vertex_normals(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int64],
    otherwise: NDArray[np.float64] = _AHEAD,
) -> NDArray[np.float64]:
    """Return (V, 3) unit normals: the mean of those of a vertex's triangles, by their area.

    Vertices at one place keep their own normals, as the lips of a closed mouth must.

    Parameters
    ----------
    vertices
        (V, 3).
    faces
        (F, 3), counter-clockwise as seen from outside.
    otherwise
        The normal of a vertex that has no triangle with an area.
    """
    first, second, third = (vertices[faces[:, corner]] for corner in range(3))
    # a cross product is as long as twice the triangle's area
    across = np.repeat(np.cross(second - first, third - first), 3, axis=0)
    corners = faces.ravel()
    sums = np.stack(
        [np.bincount(corners, across[:, axis], len(vertices)) for axis in range(3)], axis=1
    )
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    known = lengths > 0
    return np.where(known, sums / np.where(known, lengths, 1.0), otherwise)
