"""``runs`` lists what was run, whatever state its folder is in."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph.runs.folder import EVENTS, STUDY, RunFolder
from tests.nodegraph.cli.conftest import Command


def test_runs_are_listed_with_date_and_title(command: Command) -> None:
    command("run", "toy.yaml")
    command("run", "toy.yaml", "--set", "start=-100", "--out", "runs/other")
    for name, state in [("broken", STUDY), ("stopped", EVENTS)]:
        (Path("runs") / name).mkdir()
        (Path("runs") / name / state).write_text("x")
    (Path("runs") / "empty").mkdir()
    active = RunFolder(Path("runs/active"), "nodegraph: 1")
    status, out, _ = command("runs", nodes=False)
    active.close()
    lines = {line.split()[2]: line for line in out.splitlines()}
    assert status == 0
    names = ("toy", "other", "broken", "stopped", "active")
    assert lines.keys() == {f"runs/{name}" for name in names}
    assert "A toy  --plugin" in lines["runs/toy"]
    assert "A toy (with failures)  --set start=-100" in lines["runs/other"]
    assert "cannot be read" in lines["runs/broken"]
    assert lines["runs/stopped"].endswith("interrupted")
    assert lines["runs/active"].endswith("running")


@pytest.mark.parametrize("folder", ["none", "."])
def test_a_folder_without_runs_ends_with_2(command: Command, folder: str) -> None:
    status, out, err = command("runs", folder, nodes=False)
    assert (status, out) == (2, "")
    assert folder in err
