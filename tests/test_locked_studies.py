"""Locks of the shipped graphs hold, and distinguish rounding from an edit of a method."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from nodegraph.lock.lockfile import read_lock
from tests.studies import FILL, GRAPHS, ONE, ROOT, Studies, needs_fetched

LOCKS = sorted((ROOT / "graphs").glob("*.lock"))
SMALL = (*ONE, "--only", "fill=muscle,pca,linear")
ROUNDED = """
import numpy as np

def rounded(function):
    def call(*inputs, **more):
        result = function(*inputs, **more)
        parts = result if isinstance(result, tuple) else (result,)
        off = [np.nextafter(part, np.inf) for part in parts]
        return type(result)(*off) if hasattr(result, "_fields") else off[0]
    return call

for name in ("svd", "eigh", "solve", "pinv"):
    setattr(np.linalg, name, rounded(getattr(np.linalg, name)))
"""


def nodegraph(
    *words: str, path: tuple[Path, ...] = (), folder: Path | None = None
) -> tuple[int, str]:
    """Run a command in a new process; return its exit status and output."""
    folders = [str(entry) for entry in (*path, ROOT / "plugins", ROOT)]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(folders)}
    process = subprocess.run(
        [sys.executable, "-m", "nodegraph.cli.main", *words],
        env=environment,
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return process.returncode, process.stdout + process.stderr


def test_every_shipped_graph_has_a_lock() -> None:
    assert [path.stem for path in LOCKS] == [path.stem for path in GRAPHS]


@pytest.mark.parametrize(
    "lock",
    [pytest.param(path, marks=needs_fetched(path.stem)) for path in LOCKS],
    ids=lambda path: path.stem,
)
def test_a_shipped_lock_is_of_its_graph_and_holds(
    lock: Path, studies: Studies, tmp_path: Path
) -> None:
    assert read_lock(lock).text[f"{lock.stem}.yaml"] == (lock.with_suffix(".yaml").read_text())
    ended = studies.command("verify", str(lock), folder=tmp_path)
    assert ended.status == 0, ended.out


@pytest.mark.parametrize("lock", LOCKS, ids=lambda path: path.stem)
def test_a_shipped_lock_is_small_and_has_no_path_of_a_machine(lock: Path) -> None:
    text = lock.read_text()
    assert len(text) < 400_000
    assert str(ROOT) not in text
    assert str(Path.home()) + os.sep not in text


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small lock of the fills, and the store of its run."""
    folder = tmp_path_factory.mktemp("small")
    shutil.copytree(ROOT / "plugins", folder / "plugins")
    (folder / "fill.yaml").write_text(FILL)
    words = ("lock", "fill.yaml", *SMALL, "--store", "kept")
    status, output = nodegraph(*words, path=(folder / "plugins",), folder=folder)
    assert status == 0, output
    return folder


def test_rounding_of_another_library_is_no_change(small: Path, tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text(ROUNDED)
    words = ("verify", "fill.lock", "--rerun", "--store", "kept")
    status, output = nodegraph(*words, path=(tmp_path, small / "plugins"), folder=small)
    assert status == 0, output
    assert output.startswith("within tolerance: fill.lock: ")


@pytest.mark.parametrize("stored", [True, False])
def test_an_edited_constant_of_a_method_is_located(
    small: Path, tmp_path: Path, stored: bool
) -> None:
    plugins = tmp_path / "plugins"
    shutil.copytree(small / "plugins", plugins)
    method = plugins / "nodegraph_fill" / "muscle.py"
    text = method.read_text()
    assert text.count("neighbours=3") == 1
    method.write_text(text.replace("neighbours=3", "neighbours=2"))
    store = small / "kept" if stored else tmp_path / "kept"
    words = ("verify", "fill.lock", "--store", str(store))
    status, output = nodegraph(*words, path=(plugins,), folder=small)
    lines = output[output.index("diverged: ") :].splitlines()
    assert status == 1
    assert lines[0].startswith("diverged: fill.lock: ")
    condition = "condition=own_noise, length=45, terms=ends_met"
    at = f"recording=face_1, trial=0, {condition}, fill=muscle"
    assert lines[1].startswith("    the code of 1 of ")
    assert lines[3].endswith(f" fill({at})")
    assert "nodegraph_fill.muscle was edited" in lines[4]
    assert lines[5].startswith("    by ")
    assert (" samples (frames " in lines[6]) == stored
    if stored:
        assert re.search(r"frames \d+", lines[6])
        assert re.search(r"\b[LMR]_[a-z]+\d", lines[6])
        assert "mm (frame " in lines[6]
    assert any("error (1), table" in line for line in lines[7:])
