"""three.js draws the head where the markers of the same weights are, and it moves with them."""

from __future__ import annotations

from base64 import b64decode
from collections.abc import Callable
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation, binary_erosion
from scipy.spatial.transform import Rotation

from nodegraph_blendshapes.animate_mesh import mesh
from nodegraph_blendshapes.from_head import from_head
from nodegraph_blendshapes.pose import pose
from nodegraph_files.writers import write_glb
from nodegraph_mocap import Animation, Head, HeadMotion, Trajectories, Weights
from nodegraph_synthesize.face import synthesize_face

Array = NDArray[Any]

SIZE, FIELD = 400, 30.0
EYE, TARGET = np.array([0.12, 0.06, 0.7]), np.array([0.0, 0.0, 0.02])
"""Of the camera, metres: a little from the side and from above."""

FRAMES = (0, 15, 30)
"""At rest; an expression with the head held still; another one with the head turned."""

NEAR = np.ones((3, 3), dtype=bool)
"""A pixel and its neighbours."""

SCRIPT = """
const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
renderer.setPixelRatio(1);
renderer.setSize(given.size, given.size);
renderer.setClearColor(0x000000);
renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
const lamp = new THREE.DirectionalLight(0xffffff, 2);
lamp.position.set(1, 2, 3);
shown.scene.add(lamp, new THREE.AmbientLight(0xffffff, 0.3));
const camera = new THREE.PerspectiveCamera(given.field, 1, 0.01, 10);
camera.position.fromArray(given.eye);
camera.lookAt(...given.target);
const geometry = new THREE.BufferGeometry();
const { position } = mesh.geometry.attributes;
geometry.setAttribute("position", position);
geometry.morphAttributes.position = mesh.geometry.morphAttributes.position;
geometry.morphTargetsRelative = true;
const vertices = Object.values(mesh.userData.markerVertices);
geometry.setIndex(vertices);
const colours = new Float32Array(3 * position.count);
vertices.forEach((vertex, marker) => { colours[3 * vertex] = (marker + 1) / 255; });
geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
const dots = new THREE.Points(geometry, new THREE.PointsMaterial(
  { size: 1, sizeAttenuation: false, vertexColors: true, depthTest: false }));
dots.morphTargetInfluences = mesh.morphTargetInfluences;
dots.frustumCulled = mesh.frustumCulled = false;
mesh.add(dots);
const picture = () => {
  renderer.render(shown.scene, camera);
  return renderer.domElement.toDataURL("image/png");
};
const skin = mesh.material, glass = new THREE.MeshBasicMaterial({ visible: false });
return given.times.map((time) => {
  mixer.setTime(time);
  [mesh.material, dots.visible] = [skin, false];
  const face = picture();
  [mesh.material, dots.visible] = [glass, true];
  return { face, dots: picture() };
});
"""


@pytest.fixture(scope="module")
def head() -> Head:
    return synthesize_face(seconds=0.5, markers=40).head


@pytest.fixture(scope="module")
def animation(head: Head) -> Animation:
    """Weights that another program named, one of them for a shape that the head lacks."""
    keys = ((0.0, 0.9, 0.2), (0.0, 0.7, 0.0), (0.0, 0.7, 1.0), (1.0, 1.0, 1.0))
    weights = Weights(
        values=np.array([np.interp(np.arange(31), FRAMES, key) for key in keys]).T,
        names=("JawOpen", "zygomaticMajor_L", "ZygomaticMajorRight", "TongueOut"),
        rate=30.0,
    )
    turn = np.interp(np.arange(31), FRAMES, [0.0, 0.0, 0.4])
    motion = HeadMotion(
        rotations=Rotation.from_rotvec(np.outer(turn, [0.0, 1.0, 0.0])).as_matrix(),
        translations=np.outer(turn, [20.0, -30.0, 50.0]),
        scales=1 + 0.2 * turn,
    )
    with pytest.warns(UserWarning, match="^(1 of 4 weights|23 of the head's 26 shapes) have"):
        return mesh(weights, head, motion)


@pytest.fixture(scope="module")
def markers(head: Head, animation: Animation) -> Trajectories:
    with pytest.warns(UserWarning, match="have no weight"):
        return pose(animation.weights, from_head(head).model)


def in_place(animation: Animation, points: Array, frame: int) -> Array:
    """Return (N, 3) posed points where the head motion brings them."""
    motion = animation.head_motion
    assert motion is not None
    turned = points @ motion.rotations[frame].T
    return np.asarray(motion.scales[frame] * turned + motion.translations[frame])


def pixels(points: Array) -> Array:
    """Return (N, 2) columns and rows, counted from the picture's upper left corner, of points."""
    back = (EYE - TARGET) / np.linalg.norm(EYE - TARGET)
    right = np.cross([0.0, 1.0, 0.0], back)
    right /= np.linalg.norm(right)
    seen = (points / 1000 - EYE) @ np.stack([right, np.cross(back, right), back], axis=1)
    half = np.tan(np.radians(FIELD) / 2) * -seen[:, 2]
    return np.asarray(SIZE / 2 * (1 + np.stack([seen[:, 0], -seen[:, 1]], axis=1) / half[:, None]))


def covered(corners: Array, faces: Array) -> Array:
    """Return (SIZE, SIZE) where the mesh is, triangle by triangle, of those that face us."""
    hit = np.zeros((SIZE, SIZE), dtype=bool)
    for first, second, three in corners[faces]:
        low = np.maximum(np.floor(np.minimum(np.minimum(first, second), three)), 0).astype(int)
        high = np.ceil(np.maximum(np.maximum(first, second), three)).astype(int)
        x, y = np.meshgrid(*(np.arange(low[axis], high[axis]) + 0.5 for axis in range(2)))

        def side(start: Array, stop: Array, x: Array = x, y: Array = y) -> Array:
            across = (stop[0] - start[0]) * (y - start[1]) - (stop[1] - start[1]) * (x - start[0])
            return np.asarray(across)

        # rows run downward, which turns counter-clockwise into clockwise
        inside = (side(first, second) <= 0) & (side(second, three) <= 0) & (side(three, first) <= 0)
        hit[low[1] : high[1], low[0] : high[0]] |= inside
    return hit


def decoded(address: str) -> Array:
    """Return (SIZE, SIZE, 3) bytes of a picture."""
    picture = imread(BytesIO(b64decode(address.partition(",")[2])), format="png")
    return np.asarray(np.rint(255 * np.asarray(picture)[..., :3]), dtype=np.int64)


def around(where: Array) -> tuple[slice, slice]:
    """Return the pixels that are at most three from a place."""
    column, row = (int(value) for value in where)
    return slice(row - 3, row + 4), slice(column - 3, column + 4)


def test_the_head_is_drawn_where_its_markers_are_and_moves_with_them(
    in_three: Callable[..., Any], head: Head, animation: Animation, markers: Trajectories
) -> None:
    message = in_three(
        write_glb(animation).content["animation.glb"],
        SCRIPT,
        size=SIZE,
        field=FIELD,
        eye=EYE.tolist(),
        target=TARGET.tolist(),
        times=[frame / animation.rate for frame in FRAMES],
    )
    faces, places, outlines = [], [], []
    for frame, seen in zip(FRAMES, message, strict=True):
        faces.append(decoded(seen["face"]))
        places.append(pixels(in_place(animation, markers.positions[frame], frame)))
        dots = decoded(seen["dots"])
        numbers = dots[..., 0]
        assert not dots[..., 1:].any()
        np.testing.assert_array_equal(np.unique(numbers), np.arange(len(head.markers) + 1))
        for number, expected in enumerate(places[-1], start=1):
            ((row, column),) = np.argwhere(numbers == number)
            assert np.abs([column + 0.5, row + 0.5] - expected).max() <= 1, head.markers[number - 1]
        posed = head.vertices + np.tensordot(animation.morph_weights[frame], head.morphs, axes=1)
        mask = covered(pixels(in_place(animation, posed, frame)), head.faces)
        drawn = faces[-1].any(axis=2)
        assert mask.mean() > 0.1
        assert not np.any(drawn & ~binary_dilation(mask, NEAR))
        assert not np.any(binary_erosion(mask, NEAR) & ~drawn)
        outlines.append(mask)
    # the expression alone: what it does not move is drawn alike
    changed = np.any(faces[1] != faces[0], axis=2)
    way = np.linalg.norm(places[1] - places[0], axis=1)
    moved = way > 2
    still = np.abs(markers.positions[15] - markers.positions[0]).max(axis=1) == 0
    assert moved.sum() >= 4
    assert still.sum() >= 3
    assert all(changed[around(place)].any() for place in places[1][moved])
    assert all(not changed[around(place)].any() for place in places[1][still])
    # and the head as a whole
    turned = np.any(faces[2] != faces[1], axis=2)
    assert np.linalg.norm(places[2] - places[1], axis=1).min() > 2
    assert all(turned[around(place)].any() for place in places[2])
    assert not np.any(turned & ~binary_dilation(outlines[1] | outlines[2], NEAR))
