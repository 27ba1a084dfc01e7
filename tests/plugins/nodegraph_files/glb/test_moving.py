"""Animations are read as they are written, at the times of their keys, and from other programs."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

import nodegraph as ng
from nodegraph_files import animation_bytes, head_bytes
from nodegraph_files.glb.buffers import joined_glb, split_glb
from nodegraph_files.glb.moving import is_animated
from nodegraph_mocap import Animation, HeadMotion
from nodegraph_mocap.specimens import FRAMES, animations, heads

read_animation = ng.get_node("read.animation")
STILL = animations()["complete"]
SECONDS = np.arange(FRAMES) / STILL.rate
MOVING = replace(
    STILL,
    head_motion=HeadMotion(
        rotations=Rotation.from_rotvec(np.outer(4 * np.sin(SECONDS), [0, 1, 0])).as_matrix(),
        translations=np.stack([SECONDS, 2 * SECONDS, 30 - SECONDS], axis=1),
        scales=1 + SECONDS / 10,
    ),
)


def read(path: Path, content: bytes, **settings: Any) -> Animation:
    path.write_bytes(content)
    animation: Animation = read_animation(path=path, **settings)
    return animation


def changed(animation: Animation, change: Callable[[dict[str, Any], list[Any]], None]) -> bytes:
    """Return a file whose document, and arrays of floats that it adds, something has changed."""
    text, binary = split_glb(animation_bytes(animation))
    document = json.loads(text)
    added: list[Any] = []
    change(document, added)
    for values in added:
        stored = np.asarray(values, dtype="<f4")
        view = {"buffer": 0, "byteOffset": len(binary), "byteLength": stored.nbytes}
        document["bufferViews"].append(view)
        document["accessors"].append({
            "bufferView": len(document["bufferViews"]) - 1, "componentType": 5126,
            "count": stored.size if stored.ndim == 1 else len(stored),
            "type": {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[1 if stored.ndim == 1 else stored.shape[1]],
        })  # fmt: skip
        binary += stored.tobytes()
    document["buffers"][0]["byteLength"] = len(binary)
    return joined_glb(document, binary)


def same_motion(found: Animation, expected: Animation) -> None:
    assert found.head_motion is not None
    assert expected.head_motion is not None
    for part in ("rotations", "translations", "scales"):
        was, now = (getattr(each.head_motion, part) for each in (expected, found))
        np.testing.assert_allclose(now, was, atol=2e-5)


def test_what_is_written_is_read(tmp_path: Path) -> None:
    found = read(tmp_path / "a.glb", animation_bytes(MOVING))
    assert (found.rate, found.frames, found.weights.names) == (60.0, FRAMES, MOVING.head.names)
    np.testing.assert_allclose(found.weights.values, MOVING.morph_weights, atol=1e-6)
    same_motion(found, MOVING)
    still = read(tmp_path / "b.glb", animation_bytes(animations()["one frame"]))
    assert still.frames == 1


def test_a_node_above_the_head_moves_it_from_where_it_rests(tmp_path: Path) -> None:
    def lift(document: dict[str, Any], added: list[Any]) -> None:
        document["nodes"] = [
            {"mesh": 0, "translation": [0.01, 0, 0]},
            {"children": [0], "translation": [0.1, 0.2, 0.3]},
        ]
        document["scenes"] = [{"nodes": [1]}]
        (animation,) = document["animations"]
        for channel in animation["channels"]:
            channel["target"]["node"] = int(channel["target"]["path"] != "weights")

    found = read(tmp_path / "a.glb", changed(MOVING, lift))
    np.testing.assert_allclose(
        found.head.vertices - [110, 200, 300], MOVING.head.vertices, atol=1e-3
    )
    assert found.head_motion is not None
    assert MOVING.head_motion is not None
    at_rest = found.head.vertices[7]
    now = found.head_motion
    moved = np.einsum("t,tij,j->ti", now.scales, now.rotations, at_rest) + now.translations
    was = MOVING.head_motion
    own = MOVING.head.vertices[7] + np.array([10, 0, 0])
    there = np.einsum("t,tij,j->ti", was.scales, was.rotations, own) + was.translations
    np.testing.assert_allclose(moved, there, atol=1e-3)


def test_values_between_keys_are_interpolated_as_the_file_says(tmp_path: Path) -> None:
    keys = np.array([0.5, 1.0, 1.25, 2.0])
    names = STILL.head.names
    values = np.random.default_rng(3).uniform(0, 1, (4, 3, len(names)))
    values[:, 0] = values[:, 2]  # tangents into a key and out of it

    def set_keys(kind: str) -> Callable[[dict[str, Any], list[Any]], None]:
        def change(document: dict[str, Any], added: list[Any]) -> None:
            first = len(document["accessors"])
            shown = values if kind == "CUBICSPLINE" else values[:, 1]
            added += [keys, shown.ravel()]
            (animation,) = document["animations"]
            animation["channels"] = [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]
            animation["samplers"] = [{"input": first, "output": first + 1, "interpolation": kind}]

        return change

    times = 0.5 + np.arange(31) / 20
    spline = CubicHermiteSpline(keys, values[:, 1], values[:, 2])
    at = np.searchsorted(keys, times + 1e-9, side="right") - 1
    for kind, expected in (
        ("STEP", values[at, 1]),
        ("LINEAR", np.stack([np.interp(times, keys, column) for column in values[:, 1].T], 1)),
        ("CUBICSPLINE", spline(times)),
    ):
        found = read(tmp_path / "a.glb", changed(STILL, set_keys(kind)), rate=20.0)
        assert (found.frames, found.head_motion) == (31, None)
        np.testing.assert_allclose(found.weights.values, expected, atol=1e-6)
    with pytest.warns(UserWarning, match=r"2 of 3 steps between keys are not 0\.5 s long"):
        assert read(tmp_path / "a.glb", changed(STILL, set_keys("LINEAR"))).frames == 4


def test_what_moves_and_is_not_the_head_is_told(tmp_path: Path) -> None:
    def change(document: dict[str, Any], added: list[Any]) -> None:
        document["nodes"].append({"name": "lamp"})
        document["scenes"][0]["nodes"].append(1)
        (animation,) = document["animations"]
        animation["channels"].append({"sampler": 1, "target": {"node": 1, "path": "translation"}})

    with pytest.warns(UserWarning, match="1 nodes move that do not carry the head.*: lamp"):
        read(tmp_path / "a.glb", changed(MOVING, change))


@pytest.mark.parametrize(
    ("keys", "path", "values", "message"),
    [
        ([0, 0.5, 0.4], "weights", np.zeros(9), "key 2 is not after the one before it"),
        ([0, 0.5], "weights", np.zeros(5), "5 numbers where 6 are needed"),
        ([0, 1e9], "weights", np.zeros(6), "no rate|frames at"),
        ([0, 0.5], "scale", [[1, 1, 1], [1, 2, 1]], "stretched or sheared, most in frame 1"),
        ([0, 0.5], "scale", [[1, 1, 1], [-1, 1, 1]], "vanishes or is mirrored in frame 1"),
        ([0, 0.5], "rotation", [[0, 0, 0, 1], [0, 0, 0, 0]], "node 0: its rotation is zero"),
        ([0, 0.5], "pointer", np.zeros(2), "no animation moves the head"),
    ],
)
def test_animations_that_cannot_be_read_are_refused(
    tmp_path: Path, keys: list[float], path: str, values: object, message: str
) -> None:
    def change(document: dict[str, Any], added: list[Any]) -> None:
        first = len(document["accessors"])
        added += [keys, values]
        (animation,) = document["animations"]
        animation["channels"] = [{"sampler": 0, "target": {"node": 0, "path": path}}]
        animation["samplers"] = [{"input": first, "output": first + 1}]

    rate = {"rate": 1e5} if keys[-1] == 1e9 else {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(ValueError, match=message):
            read(tmp_path / "a.glb", changed(STILL, change), **rate)


def test_a_head_alone_is_no_animation(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(head_bytes(heads()["complete"]))
    assert not is_animated(path)
    with pytest.raises(ValueError, match="no animation moves the head"):
        read_animation(path=path)
