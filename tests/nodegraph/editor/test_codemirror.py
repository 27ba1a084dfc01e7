"""CodeMirror in the page is what its packages are built into.

Set ``NODEGRAPH_CODEMIRROR`` to a folder in which ``npm ci`` has run with the package.json and the
package-lock.json of ``nodegraph/editor/codemirror``.
"""

from __future__ import annotations

import gzip
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.environments import ROOT

FOLDER = ROOT / "nodegraph" / "editor" / "codemirror"
PACKAGES = os.environ.get("NODEGRAPH_CODEMIRROR", "")
MOST = 300_000


@pytest.mark.skipif(not PACKAGES, reason="NODEGRAPH_CODEMIRROR names no folder of packages")
def test_the_bundle_is_built_from_its_packages(tmp_path: Path) -> None:
    for name in ("build.mjs", "entry.js", "package.json"):
        shutil.copy(FOLDER / name, tmp_path)
    (tmp_path / "node_modules").symlink_to(Path(PACKAGES, "node_modules"))
    (tmp_path / "out").mkdir()
    subprocess.run(["node", "build.mjs", "out"], cwd=tmp_path, check=True)
    for name in ("codemirror.js", "LICENSES.txt"):
        assert (tmp_path / "out" / name).read_bytes() == (FOLDER / name).read_bytes()


def test_every_package_in_the_bundle_has_its_licence() -> None:
    notices = (FOLDER / "LICENSES.txt").read_text("utf-8")
    locked = json.loads((FOLDER / "package-lock.json").read_text("utf-8"))["packages"]
    for path, package in locked.items():
        name = path.rpartition("node_modules/")[2]
        if name and not package.get("dev"):
            assert f"{name} {package['version']}\n" in notices
            assert package["license"] == "MIT"
    assert (
        notices.count("Permission is hereby granted") == len(re.findall(r"(?m)^-+$", notices)) + 1
    )


def test_the_bundle_is_small_and_fetches_nothing() -> None:
    content = (FOLDER / "codemirror.js").read_bytes()
    assert len(gzip.compress(content)) < MOST
    assert set(re.findall(rb"https?://[\w./]+", content)) <= {b"http://www.w3.org/2000/svg"}
    assert "resolved" not in (FOLDER / "package-lock.json").read_text("utf-8")
