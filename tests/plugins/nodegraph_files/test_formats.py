"""A plugin adds a format, which the nodes of this package read as any other."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nodegraph.cli.main import main
from tests.records import read_record

TOY = """
import numpy as np
from nodegraph import Format, hookimpl
from nodegraph_mocap import Trajectories


def read(path, *, zeros_missing, unit, rate):
    text = path.read_text()
    if "bad" in text:
        raise {error}(f"{{path}}: bad toy")
    positions = np.full((2, 1, 3), {scale} * float(text.split()[1]))
    return Trajectories(positions=positions, markers=("toy",), rate=60.0)


@hookimpl
def nodegraph_formats():
    return [Format("Toy", Trajectories, (".toy",), read, lambda start: start.startswith(b"TOY "))]
"""
GRAPH = """
nodegraph: 1
nodes:
  take: {{use: read.recording, with: {{path: "{path}"}}}}
  file: {{use: write.npz, in: take}}
report: [file]
"""
Run = Callable[..., tuple[str, Path]]


def write_plugin(*, scale: float = 1.0, error: str = "ValueError") -> None:
    path = Path("toy.py")
    path.write_text(TOY.format(scale=scale, error=error))
    past = time.time_ns() - 10**10
    os.utime(path, ns=(past, past))


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Run a graph that reads a path; return the state of the reading step and the run folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("NODEGRAPH_STORE", str(tmp_path / "store"))

    def call(path: str, *words: str) -> tuple[str, Path]:
        Path("graph.yaml").write_text(GRAPH.format(path=path))
        out = tmp_path / f"run{len(list(tmp_path.glob('run*')))}"
        main(["run", "graph.yaml", "--plugin", "toy.py", "--out", str(out), *words])
        step = read_record(out)["steps"][0]
        state = "stored" if step.get("stored") else step["state"]
        return f"{state} {step.get('reason', '')}".strip(), out

    return call


def positions(folder: Path) -> float:
    (file,) = folder.rglob("recording.npz")
    with np.load(file) as archive:
        return float(archive["positions"][0, 0, 0])


@pytest.mark.parametrize(
    ("name", "content", "executor"),
    [
        ("take.csv", "TOY 5", "serial"),
        ("take.TOY", "other 5", "threads"),
        ("folder/recording.toy", "other 5", "processes"),
    ],
)
def test_it_is_recognized_by_content_suffix_and_name_in_a_folder(
    run: Run, name: str, content: str, executor: str
) -> None:
    write_plugin()
    path = Path(name)
    path.parent.mkdir(exist_ok=True)
    path.write_text(content)
    state, folder = run(name.partition("/")[0], "--executor", executor)
    assert (state, positions(folder)) == ("done", 5.0)


def test_editing_a_format_computes_what_is_read_again(run: Run) -> None:
    Path("take.toy").write_text("TOY 5")
    write_plugin()
    assert run("take.toy")[0] == "done"
    assert run("take.toy")[0] == "stored"
    write_plugin(scale=2.0)
    state, folder = run("take.toy")
    assert (state, positions(folder)) == ("done", 10.0)


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        ("ValueError", "take.toy: bad toy"),
        ("KeyError", "plugin 'toy': the format Toy, from hook nodegraph_formats, failed: KeyError"),
    ],
)
def test_a_reader_that_fails_is_named_unless_it_refuses_the_file(
    run: Run, error: str, reason: str
) -> None:
    Path("take.toy").write_text("bad")
    write_plugin(error=error)
    state, _ = run("take.toy")
    assert state.startswith("failed")
    assert reason in state
    assert ("plugin" in state) == (error == "KeyError")


def test_a_file_of_no_format_lists_those_that_there_are(run: Run) -> None:
    Path("take.xyz").write_text("nothing known")
    write_plugin()
    state, _ = run("take.xyz")
    assert "take.xyz" in state
    assert all(name in state for name in ("Toy (.toy)", "C3D (.c3d)", ".tsv", "NPZ", "TRC"))
