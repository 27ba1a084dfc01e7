"""A program that knows nothing of ours shows the vertices that we mean: three.js, in a browser.

Set ``NODEGRAPH_THREE`` to the folder of the package ``three``, as ``npm pack three`` gives it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from html import unescape
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph_mocap import Animation, HeadMotion, animation_bytes
from nodegraph_mocap.specimens import animations

THREE = os.environ.get("NODEGRAPH_THREE", "")
BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
pytestmark = [
    pytest.mark.skipif(not THREE, reason="NODEGRAPH_THREE names no folder of three.js"),
    pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed"),
]
QUIET = [
    *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
    *("--virtual-time-budget=20000", "--dump-dom"),
]
FRAMES = (0.0, 7.0, 22.5, 39.0)
"""Also half-way between two frames."""

PAGE = """\
<!doctype html><meta charset="utf-8"><title>shown</title>
<script type="importmap">
{"imports": {"three": "./three/build/three.module.js", "three/addons/": "./three/examples/jsm/"}}
</script>
<pre></pre>
<script type="module">
const told = document.querySelector("pre");
try {
  const THREE = await import("three");
  const { GLTFLoader } = await import("three/addons/loaders/GLTFLoader.js");
  const shown = await new GLTFLoader().loadAsync("animation.glb");
  const mixer = new THREE.AnimationMixer(shown.scene);
  const action = mixer.clipAction(shown.animations[0]);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  let mesh;
  shown.scene.traverse((one) => { if (one.isMesh) mesh = one; });
  const point = new THREE.Vector3();
  const seen = TIMES.map((time) => {
    mixer.setTime(time);
    shown.scene.updateMatrixWorld(true);
    return Array.from({ length: mesh.geometry.attributes.position.count }, (_, vertex) =>
      mesh.getVertexPosition(vertex, point).applyMatrix4(mesh.matrixWorld).toArray());
  });
  const names = Object.entries(mesh.morphTargetDictionary).sort((a, b) => a[1] - b[1]);
  told.textContent = JSON.stringify({
    seen, names: names.map(([name]) => name), faces: Array.from(mesh.geometry.index.array),
    markers: mesh.userData.markerVertices, duration: shown.animations[0].duration,
  });
} catch (error) {
  told.textContent = JSON.stringify({ error: String(error) });
}
</script>
"""


class Quiet(SimpleHTTPRequestHandler):
    """Serves a folder, and three.js beside it."""

    def translate_path(self, path: str) -> str:
        plain = path.partition("?")[0]
        if plain.startswith("/three/"):
            return str(Path(THREE) / plain.removeprefix("/three/"))
        return super().translate_path(path)

    def log_message(self, *_: Any) -> None:
        """Say nothing."""


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(tmp_path)))
    Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


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
        one * morph for one, morph in zip(weights, head.morphs, strict=True)
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


def shown(address: str, folder: Path, animation: Animation) -> dict[str, Any]:
    times = json.dumps([frame / animation.rate for frame in FRAMES])
    (folder / "animation.glb").write_bytes(animation_bytes(animation))
    (folder / "index.html").write_text(PAGE.replace("TIMES", times), encoding="utf-8")
    command = [str(BROWSER), *QUIET, f"--user-data-dir={folder / 'profile'}"]
    done = subprocess.run(
        [*command, f"{address}/index.html"], capture_output=True, text=True, timeout=120, check=True
    )
    found = re.search("<pre>(.*)</pre>", done.stdout, re.DOTALL)
    assert found is not None, done.stdout
    told: dict[str, Any] = json.loads(unescape(found[1]))
    assert "error" not in told, told
    return told


def test_three_js_shows_what_we_mean(address: str, tmp_path: Path, animation: Animation) -> None:
    told = shown(address, tmp_path, animation)
    head = animation.head
    assert told["names"] == list(head.names)
    assert told["faces"] == head.faces.ravel().tolist()
    assert list(told["markers"]) == list(head.markers)
    assert told["duration"] == pytest.approx((animation.frames - 1) / animation.rate, rel=1e-6)
    for frame, seen in zip(FRAMES, told["seen"], strict=True):
        whole = int(frame)
        at_rest = frame == whole
        pose = expected(animation, whole) if at_rest else expected(between(animation, whole), 0)
        np.testing.assert_allclose(np.array(seen) * 1000, pose, rtol=0, atol=1e-3)
