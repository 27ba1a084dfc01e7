from __future__ import annotations

import json
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph_files import animation_bytes, head_bytes
from nodegraph_files.glb.buffers import Accessors, split_glb
from nodegraph_files.glb.document import read_document
from nodegraph_files.glb.writing import vertex_normals
from nodegraph_files.readers import read_head
from nodegraph_mocap import Animation, Head, HeadMotion
from nodegraph_mocap.specimens import animations, heads

HEAD = heads()["complete"]
COMPLETE = animations()["complete"]


def moving(animation: Animation = COMPLETE) -> Animation:
    frames = animation.frames
    angle = np.linspace(0, 4, frames)
    turns = np.zeros((frames, 3, 3))
    turns[:, 1, 1] = 1
    turns[:, 0, 0] = turns[:, 2, 2] = np.cos(angle)
    turns[:, 0, 2] = np.sin(angle)
    turns[:, 2, 0] = -np.sin(angle)
    motion = HeadMotion(
        rotations=turns,
        translations=np.random.default_rng(0).normal(0, 50, (frames, 3)),
        scales=np.linspace(0.9, 1.1, frames),
    )
    return replace(animation, head_motion=motion)


def tracks(content: bytes) -> dict[str, tuple[Any, Any]]:
    """Return times and values of each track of the first animation."""
    text, binary = split_glb(content)
    plain = json.loads(text)
    accessors = Accessors(read_document(text), binary)
    (animation,) = plain["animations"]
    animated = {}
    for channel in animation["channels"]:
        assert channel["target"]["node"] == 0
        sampler = animation["samplers"][channel["sampler"]]
        assert sampler["interpolation"] == "LINEAR"
        kind = plain["accessors"][sampler["output"]]["type"]
        clock = accessors.numbers(sampler["input"], "input", kind="SCALAR")[:, 0]
        values = accessors.numbers(sampler["output"], "output", kind=kind)
        animated[channel["target"]["path"]] = (clock, values)
    return animated


@pytest.mark.parametrize(
    "head",
    [
        HEAD,
        replace(HEAD, markers=(), marker_vertices=np.zeros(0, np.int64)),
        replace(HEAD, names=(), morphs=np.zeros((0, 10, 3))),
        replace(HEAD, names=("é", 'a "b"', "\u3042"), vertices=HEAD.vertices + 12_345.678),
    ],
    ids=["complete", "without markers", "without morph targets", "odd names, far away"],
)
@pytest.mark.filterwarnings("ignore:.*which no head is")
def test_what_is_written_reads_back_to_single_precision(head: Head, tmp_path: Path) -> None:
    path = tmp_path / "head.glb"
    path.write_bytes(head_bytes(head))
    back = read_head(path=path)
    np.testing.assert_allclose(back.vertices, head.vertices, rtol=1e-7, atol=1e-30)
    np.testing.assert_allclose(back.morphs, head.morphs, rtol=1e-7, atol=1e-30)
    np.testing.assert_array_equal(back.faces, head.faces)
    np.testing.assert_array_equal(back.marker_vertices, head.marker_vertices)
    assert (back.names, back.markers) == (head.names, head.markers)
    assert head_bytes(back) == head_bytes(head)


def test_the_head_of_an_animation_reads_back_at_rest(tmp_path: Path) -> None:
    path = tmp_path / "animation.glb"
    path.write_bytes(animation_bytes(moving()))
    back = read_head(path=path)
    np.testing.assert_allclose(back.vertices, HEAD.vertices, rtol=1e-7)
    assert back.markers == HEAD.markers


def test_an_animation_has_a_key_per_frame() -> None:
    animation = moving()
    motion = animation.head_motion
    assert motion is not None
    animated = tracks(animation_bytes(animation))
    assert set(animated) == {"weights", "translation", "rotation", "scale"}
    for clock, _ in animated.values():
        np.testing.assert_allclose(clock, np.arange(animation.frames) / animation.rate, rtol=1e-7)
    weights = animated["weights"][1].reshape(animation.frames, -1)
    np.testing.assert_allclose(weights, animation.morph_weights, rtol=1e-7)
    np.testing.assert_allclose(animated["translation"][1] * 1000, motion.translations, rtol=1e-7)
    np.testing.assert_allclose(animated["scale"][1], motion.scales[:, None].repeat(3, 1), rtol=1e-7)
    turns = animated["rotation"][1]
    # about y: sine and cosine of half the angle, which passes 180 degrees
    half = np.linspace(0, 4, animation.frames) / 2
    expected = np.stack([0 * half, np.sin(half), 0 * half, np.cos(half)], axis=1)
    np.testing.assert_allclose(turns * np.sign(turns[0, 3]), expected, atol=1e-7)


def test_a_still_head_has_weights_alone() -> None:
    assert set(tracks(animation_bytes(replace(COMPLETE, head_motion=None)))) == {"weights"}


def test_a_missing_weight_does_not_reach_the_file() -> None:
    with pytest.warns(UserWarning, match="7 weights in 7 frames are missing"):
        animated = tracks(animation_bytes(animations()["gaps"]))
    weights = animated["weights"][1].reshape(-1, 3)
    assert np.ptp(weights[:4, 0]) == 0
    assert np.ptp(weights[9:14, 1]) == 0


def test_an_animation_without_anything_that_changes_is_a_head() -> None:
    head = replace(HEAD, names=(), morphs=np.zeros((0, 10, 3)))
    weights = replace(COMPLETE.weights, values=np.zeros((4, 0)), names=())
    text, _ = split_glb(animation_bytes(Animation(head=head, weights=weights)))
    assert "animations" not in json.loads(text)


def test_an_animation_without_frames_is_refused() -> None:
    weights = replace(COMPLETE.weights, values=np.zeros((0, 3)))
    with pytest.raises(ValueError, match="the animation has no frames"):
        animation_bytes(Animation(head=HEAD, weights=weights))


def test_a_head_without_faces_is_refused() -> None:
    with pytest.raises(ValueError, match="the head has no faces"):
        head_bytes(replace(HEAD, faces=np.zeros((0, 3), np.int64)))


def test_numbers_beyond_single_precision_are_refused() -> None:
    with pytest.raises(ValueError, match=r"vertices: 1e\+57 is too large for a GLB file"):
        head_bytes(replace(HEAD, vertices=np.full((10, 3), 1e60)))


def test_every_accessor_of_vertices_tells_its_bounds_and_views_are_aligned() -> None:
    text, binary = split_glb(animation_bytes(moving()))
    document = json.loads(text)
    accessors = Accessors(read_document(text), binary)
    primitive = document["meshes"][0]["primitives"][0]
    used = [primitive["attributes"], *primitive["targets"]]
    for index in (attributes["POSITION"] for attributes in used):
        values = accessors.numbers(index, "", kind="VEC3")
        np.testing.assert_array_equal(document["accessors"][index]["min"], values.min(axis=0))
        np.testing.assert_array_equal(document["accessors"][index]["max"], values.max(axis=0))
    assert all(view["byteOffset"] % 4 == 0 for view in document["bufferViews"])
    assert document["asset"]["version"] == "2.0"


def normals(head: Head) -> list[Any]:
    """Return the stored (V, 3) normals at rest, and their offsets per morph target."""
    text, binary = split_glb(head_bytes(head))
    accessors = Accessors(read_document(text), binary)
    primitive = json.loads(text)["meshes"][0]["primitives"][0]
    return [
        accessors.numbers(attributes["NORMAL"], "", kind="VEC3")
        for attributes in (primitive["attributes"], *primitive["targets"])
    ]


def test_normals_fit_the_mesh_at_rest_and_in_each_morph_target() -> None:
    at_rest, *offsets = normals(HEAD)
    np.testing.assert_allclose(at_rest, vertex_normals(HEAD.vertices, HEAD.faces), atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(at_rest, axis=1), 1, atol=1e-6)
    for morph, offset in zip(HEAD.morphs, offsets, strict=True):
        posed = vertex_normals(HEAD.vertices + morph, HEAD.faces)
        np.testing.assert_allclose(at_rest + offset, posed, atol=1e-5)
        assert np.abs(offset).max() > 0.01


def test_a_morph_target_that_makes_a_triangle_vanish_leaves_its_normals() -> None:
    faces = HEAD.faces[:1]
    collapse = np.zeros((1, 10, 3))
    collapse[0, faces[0]] = HEAD.vertices[faces[0, 0]] - HEAD.vertices[faces[0]]
    head = replace(HEAD, faces=faces, names=("shut",), morphs=collapse)
    # whole metres, so that the corners meet in single precision as well
    vertices, morphs = 1000 * head.vertices.round(), 1000 * head.morphs.round()
    head = replace(head, vertices=vertices, morphs=morphs)
    _, offsets = normals(head)
    assert not offsets.any()


def test_another_library_reads_the_same_mesh() -> None:
    import trimesh

    scene = trimesh.load_scene(BytesIO(head_bytes(HEAD)), file_type="glb", process=False)
    (mesh,) = scene.geometry.values()
    np.testing.assert_allclose(mesh.vertices * 1000, HEAD.vertices, rtol=1e-7)
    np.testing.assert_array_equal(mesh.faces, HEAD.faces)
    assert mesh.metadata["targetNames"] == list(HEAD.names)
    np.testing.assert_allclose(
        mesh.vertex_normals, vertex_normals(HEAD.vertices, HEAD.faces), atol=1e-6
    )
