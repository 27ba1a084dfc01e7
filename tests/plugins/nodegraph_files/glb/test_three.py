"""A program that knows nothing about ours shows the vertices that we mean."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_files import animation_bytes
from nodegraph_files.glb.writing import vertex_normals
from nodegraph_mocap import Animation, HeadMotion
from nodegraph_mocap.specimens import animations

FRAMES = (0.0, 7.0, 22.5, 39.0)
"""Also half-way between two frames."""

SCRIPT = """
const point = new THREE.Vector3();
const { position, normal } = mesh.geometry.attributes;
const seen = given.times.map((time) => {
  mixer.setTime(time);
  shown.scene.updateMatrixWorld(true);
  return Array.from({ length: position.count }, (_, vertex) =>
    mesh.getVertexPosition(vertex, point).applyMatrix4(mesh.matrixWorld).toArray());
});
const names = Object.entries(mesh.morphTargetDictionary).sort((a, b) => a[1] - b[1]);
return {
  seen, names: names.map(([name]) => name), faces: Array.from(mesh.geometry.index.array),
  markers: mesh.userData.markerVertices, duration: shown.animations[0].duration,
  normals: Array.from(normal.array), flat: mesh.material.flatShading,
  bent: mesh.geometry.morphAttributes.normal.map((one) => Array.from(one.array)),
};
"""


@pytest.fixture
def animation() -> Animation:
    complete = animations()["complete"]
    frames = complete.frames
    turns = Rotation.from_euler("yxz", np.linspace([0, 0, 0], [4.0, 0.5, -0.3], frames)).as_matrix()
    motion = HeadMotion(
        rotations=turns,
        translations=np.random.default_rng(5).normal(0, 40, (frames, 3)),
        scales=np.linspace(0.9, 1.2, frames),
    )
    return replace(complete, head_motion=motion)


def expected(animation: Animation, frame: int) -> NDArray[np.float64]:
    """Return (V, 3) millimetres of the vertices in a frame, said plainly."""
    head, motion = animation.head, animation.head_motion
    assert motion is not None
    weights = animation.morph_weights[frame]
    posed = head.vertices + sum(
        weight * morph for weight, morph in zip(weights, head.morphs, strict=True)
    )
    turned = posed @ motion.rotations[frame].T
    return np.asarray(motion.scales[frame] * turned + motion.translations[frame])


def between(animation: Animation, frame: int) -> Animation:
    """Return the animation of the one pose half-way from a frame to the next."""
    motion = animation.head_motion
    assert motion is not None
    both = slice(frame, frame + 2)
    turns = Rotation.from_matrix(motion.rotations[both])
    half = Rotation.from_rotvec((turns[1] * turns[0].inv()).as_rotvec() / 2) * turns[0]
    return replace(
        animation,
        weights=replace(
            animation.weights, values=animation.weights.values[both].mean(axis=0, keepdims=True)
        ),
        head_motion=HeadMotion(
            rotations=half.as_matrix()[None],
            translations=motion.translations[both].mean(axis=0, keepdims=True),
            scales=motion.scales[both].mean(keepdims=True),
        ),
    )


def test_three_js_shows_what_we_mean(in_three: Callable[..., Any], animation: Animation) -> None:
    times = [frame / animation.rate for frame in FRAMES]
    answers = in_three(animation_bytes(animation), SCRIPT, times=times)
    head = animation.head
    assert answers["names"] == list(head.names)
    assert answers["faces"] == head.faces.ravel().tolist()
    assert list(answers["markers"]) == list(head.markers)
    assert answers["duration"] == pytest.approx((animation.frames - 1) / animation.rate, rel=1e-6)
    for frame, seen in zip(FRAMES, answers["seen"], strict=True):
        whole = int(frame)
        at_rest = frame == whole
        pose = expected(animation, whole) if at_rest else expected(between(animation, whole), 0)
        np.testing.assert_allclose(np.array(seen) * 1000, pose, rtol=0, atol=1e-3)
    normals = vertex_normals(head.vertices, head.faces)
    assert not answers["flat"]
    np.testing.assert_allclose(np.reshape(answers["normals"], (-1, 3)), normals, atol=1e-6)
    for bent, morph in zip(answers["bent"], head.morphs, strict=True):
        posed = vertex_normals(head.vertices + morph, head.faces)
        np.testing.assert_allclose(np.reshape(bent, (-1, 3)), posed - normals, atol=1e-5)
