"""Every shipped graph has a lock that holds here, and a lock tells rounding from change."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from nodegraph.lock.lockfile import read_lock

ROOT = Path(__file__).parents[1]
GRAPHS = sorted((ROOT / "graphs").glob("*.yaml"))
LOCKS = sorted((ROOT / "graphs").glob("*.lock"))
FILL = str(ROOT / "graphs" / "fill.yaml")
SMALL = ("--axis", "trial=0", "--axis", "length=45", "--only", "fill=muscle,pca,linear")
ROUNDED = """
import numpy as np

def rounded(function):
    def call(*inputs, **more):
        found = function(*inputs, **more)
        parts = found if isinstance(found, tuple) else (found,)
        off = [np.nextafter(one, np.inf) for one in parts]
        return type(found)(*off) if hasattr(found, "_fields") else off[0]
    return call

for name in ("svd", "eigh", "solve", "pinv"):
    setattr(np.linalg, name, rounded(getattr(np.linalg, name)))
"""
Told = Callable[..., tuple[int, str]]


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the locked studies are stored: what two of them have in common runs once."""
    return tmp_path_factory.mktemp("store")


def told(*words: str, path: tuple[Path, ...] = (), folder: Path | None = None) -> tuple[int, str]:
    """Give a command in a new process, and return its status and all that it prints."""
    places = [str(one) for one in (*path, ROOT / "plugins", ROOT)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(places)}
    ended = subprocess.run(
        [sys.executable, "-m", "nodegraph.cli.main", *words],
        env=environment,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return ended.returncode, ended.stdout + ended.stderr


def test_every_shipped_graph_has_a_lock() -> None:
    assert [one.stem for one in LOCKS] == [one.stem for one in GRAPHS]


@pytest.mark.parametrize("lock", LOCKS, ids=lambda path: path.stem)
def test_a_shipped_lock_is_of_the_graph_beside_it_and_holds(lock: Path, store: Path) -> None:
    assert read_lock(lock).study.text[f"{lock.stem}.yaml"] == (
        lock.with_suffix(".yaml").read_text()
    )
    status, said = told("verify", str(lock), "--store", str(store))
    assert status == 0, said


@pytest.mark.parametrize("lock", LOCKS, ids=lambda path: path.stem)
def test_a_shipped_lock_is_small_and_of_no_machine(lock: Path) -> None:
    text = lock.read_text()
    assert len(text) < 400_000
    assert str(ROOT) not in text
    assert str(Path.home()) + os.sep not in text


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small lock of the fills, and the store that it was made with."""
    folder = tmp_path_factory.mktemp("small")
    shutil.copytree(ROOT / "plugins", folder / "plugins")
    shutil.copy(FILL, folder)
    words = ("lock", "fill.yaml", *SMALL, "--store", "kept")
    status, said = told(*words, path=(folder / "plugins",), folder=folder)
    assert status == 0, said
    return folder


def test_rounding_of_another_library_is_no_change(small: Path, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(ROUNDED)
    words = ("verify", "fill.lock", "--rerun", "--store", "kept")
    status, said = told(*words, path=(tmp_path, small / "plugins"), folder=small)
    assert status == 0, said
    assert said.startswith("within tolerance: fill.lock: ")


@pytest.mark.parametrize("stored", [True, False])
def test_an_edited_constant_of_a_method_is_found_where_it_is(
    small: Path, tmp_path: Path, stored: bool
) -> None:
    plugins = tmp_path / "plugins"
    shutil.copytree(small / "plugins", plugins)
    method = plugins / "nodegraph_fill" / "muscle.py"
    text = method.read_text()
    assert text.count("neighbours=3") == 1
    method.write_text(text.replace("neighbours=3", "neighbours=2"))
    kept = small / "kept" if stored else tmp_path / "kept"
    words = ("verify", "fill.lock", "--store", str(kept))
    status, said = told(*words, path=(plugins,), folder=small)
    lines = said[said.index("diverged: ") :].splitlines()
    assert status == 1
    assert lines[0].startswith("diverged: fill.lock: ")
    assert lines[2] == "first: fill(trial=0, length=45, fill=muscle)"
    assert lines[3] == "    code: nodegraph_fill.muscle:muscle was edited"
    assert lines[4].startswith("    by ")
    assert lines[5].startswith("    output")
    assert re.search(r"frames \d+", lines[5])
    assert re.search(r"\b[LMR]_[a-z]+\d", lines[5])
    assert ("mm (frame " in lines[5]) == stored
    assert any(one.startswith("what follows from that: error (1), table") for one in lines)
