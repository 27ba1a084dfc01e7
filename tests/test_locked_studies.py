"""Locks of the shipped graphs hold, and distinguish rounding from an edit of a method."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph.lock.lockfile import read_lock
from tests.studies import FILL, GRAPHS, OF_SAMPLES, ONE, ROOT, Studies, command, needs_fetched

LOCKS = sorted((ROOT / "graphs").glob("*.lock"))
SMALL = (*ONE, "--only", "fill=muscle,pca,linear")


def rounded(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of numpy whose results are the next larger numbers."""

    def call(*inputs: Any, **more: Any) -> Any:
        result = function(*inputs, **more)
        parts = result if isinstance(result, tuple) else (result,)
        off = [np.nextafter(part, np.inf) for part in parts]
        return type(result)(*off) if hasattr(result, "_fields") else off[0]

    return call


def test_every_shipped_graph_has_a_lock() -> None:
    assert [path.stem for path in LOCKS] == [path.stem for path in GRAPHS]


@pytest.mark.parametrize(
    "lock",
    [pytest.param(path, marks=needs_fetched(path.stem)) for path in LOCKS],
    ids=lambda path: path.stem,
)
def test_a_shipped_lock_is_of_its_graph_and_holds_with_nothing_computed_again(
    lock: Path, studies: Studies, tmp_path: Path
) -> None:
    assert read_lock(lock).text[f"{lock.stem}.yaml"] == (lock.with_suffix(".yaml").read_text())
    studies.few(lock.stem)
    ended = studies.command("verify", str(lock), folder=tmp_path)
    if lock.stem not in OF_SAMPLES:
        assert re.search(r"finished after .*: \d+ already stored(, \d+ refused)?\n$", ended.err)
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
    (folder / "fill.yaml").write_text(FILL)
    ended = command("lock", "fill.yaml", *SMALL, "--store", "kept", folder=folder)
    assert ended.status == 0, ended.err
    return folder


def test_rounding_of_another_library_is_no_change(
    small: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("svd", "eigh", "solve", "pinv"):
        monkeypatch.setattr(np.linalg, name, rounded(getattr(np.linalg, name)))
    ended = command("verify", "fill.lock", "--rerun", "--store", "kept", folder=small)
    assert ended.status == 0, ended.out
    assert ended.out.startswith("within tolerance: fill.lock: ")


def test_an_edited_constant_of_a_method_is_located(small: Path, tmp_path: Path) -> None:
    plugins = tmp_path / "plugins"
    shutil.copytree(ROOT / "plugins", plugins)
    method = plugins / "nodegraph_fill" / "muscle.py"
    text = method.read_text()
    assert text.count("neighbours=3") == 1
    method.write_text(text.replace("neighbours=3", "neighbours=2"))
    process = subprocess.run(
        [sys.executable, "-m", "nodegraph.cli.main", "verify", "fill.lock", "--store", "kept"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(plugins), str(ROOT)])},
        cwd=small,
        capture_output=True,
        text=True,
        check=False,
    )
    status, output = process.returncode, process.stdout
    lines = output[output.index("diverged: ") :].splitlines()
    assert status == 1
    assert lines[0].startswith("diverged: fill.lock: ")
    condition = "condition=own_noise, length=45, terms=ends_met"
    at = f"recording=face_1, trial=0, {condition}, fill=muscle"
    assert lines[1].startswith("    the code of 1 of ")
    assert lines[3].endswith(f" fill({at})")
    assert "nodegraph_fill.muscle was edited" in lines[4]
    assert lines[5].startswith("    by ")
    assert re.search(r" samples \(frames \d+", lines[6])
    assert re.search(r"\b[LMR]_[a-z]+\d", lines[6])
    assert "mm (frame " in lines[6]
    assert any("error (1), table" in line for line in lines[7:])
