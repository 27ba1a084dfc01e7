"""What shows GLB files in a program that knows nothing about ours: three.js, in a browser.

Set ``NODEGRAPH_THREE`` to the folder of the package ``three``, as ``npm pack three`` gives it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page, Route

THREE = os.environ.get("NODEGRAPH_THREE", "")
HOST = "http://127.0.0.1/"

PAGE = """\
<!doctype html><meta charset="utf-8"><title>shown</title><link rel="icon" href="data:,">
<script type="importmap">
{"imports": {"three": "./three/build/three.module.js", "three/addons/": "./three/examples/jsm/"}}
</script>
<script type="module">
globalThis.shows = (async () => {
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
  const given = GIVEN;
  SCRIPT
})();
</script>
"""


@pytest.fixture
def in_three(tab: Page) -> Callable[..., object]:
    """What loads a GLB file with an animation, runs a script and returns what that returns.

    The script finds ``THREE``, ``shown`` (the file), its ``mixer`` and ``mesh``, and ``given``.
    """
    if not THREE:
        pytest.skip("NODEGRAPH_THREE names no folder of three.js")

    def run(content: bytes, script: str, **given: object) -> object:
        page = PAGE.replace("GIVEN", json.dumps(given)).replace("SCRIPT", script)

        def answer(route: Route) -> None:
            name = route.request.url.removeprefix(HOST)
            if name.startswith("three/"):
                route.fulfill(path=Path(THREE, name.removeprefix("three/")))
            elif name == "animation.glb":
                route.fulfill(body=content)
            else:
                route.fulfill(body=page, content_type="text/html")

        tab.route(f"{HOST}**", answer)
        tab.goto(HOST)
        return tab.evaluate("shows")

    return run
