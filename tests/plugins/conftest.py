"""What shows GLB files in a program that knows nothing of ours: three.js, in a browser.

Set ``NODEGRAPH_THREE`` to the folder of the package ``three``, as ``npm pack three`` gives it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from functools import partial
from html import unescape
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

THREE = os.environ.get("NODEGRAPH_THREE", "")
BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
QUIET = [
    *("--headless", "--no-sandbox", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
    *("--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--virtual-time-budget=20000", "--dump-dom"),
]

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
  const given = GIVEN;
  const tell = () => { SCRIPT };
  told.textContent = JSON.stringify(tell());
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
def in_three(tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """What loads a GLB file with an animation, runs a script and returns what that returns.

    The script finds ``THREE``, ``shown`` (the file), its ``mixer`` and ``mesh``, and ``given``.
    """
    if not THREE:
        pytest.skip("NODEGRAPH_THREE names no folder of three.js")
    if BROWSER is None:
        pytest.skip("no Chromium is installed")
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(tmp_path)))
    Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/index.html"

    def run(content: bytes, script: str, **given: Any) -> Any:
        page = PAGE.replace("GIVEN", json.dumps(given)).replace("SCRIPT", script)
        (tmp_path / "animation.glb").write_bytes(content)
        (tmp_path / "index.html").write_text(page, encoding="utf-8")
        return told_by(address, tmp_path / "profile")

    yield run
    server.shutdown()
    server.server_close()


def told_by(address: str, profile: Path) -> Any:
    """Return what a page writes into its only <pre>."""
    command = [str(BROWSER), *QUIET, f"--user-data-dir={profile}", address]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    found = re.search("<pre>(.*)</pre>", done.stdout, re.DOTALL)
    assert found is not None, done.stdout
    told = json.loads(unescape(found[1]))
    assert "error" not in told, told
    return told
