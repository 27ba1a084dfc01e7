"""``run`` ends with 0, 1 when a step failed, 2 when it cannot begin."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

Command = Callable[..., tuple[int, str, str]]


def test_a_run_writes_its_folder_and_ends_with_0(command: Command) -> None:
    status, out, _ = command("run", "toy.yaml", "--executor", "serial")
    assert status == 0
    assert "runs/toy" in out
    for name in ("report.html", "run.json", "graph.yaml", "events.jsonl"):
        assert (Path("runs/toy") / name).is_file()
    assert Path("runs/toy/graph.yaml").read_text() == Path("toy.yaml").read_text()


def test_a_second_run_keeps_the_first(command: Command) -> None:
    command("run", "toy.yaml", "--out", "here")
    status, _, err = command("run", "toy.yaml", "--out", "here", "--jobs", "1")
    assert status == 0
    assert "the earlier run is now in here-" in err
    assert len([one for one in Path().iterdir() if one.name.startswith("here")]) == 2


def test_a_refusal_is_no_failure(command: Command) -> None:
    status, _, err = command("run", "toy.yaml", "--set", "start=-8")
    assert status == 0
    assert "refused: fill(length=5, fill=strict): too small" in err


def test_a_failed_step_ends_with_1(command: Command) -> None:
    status, out, err = command("run", "toy.yaml", "--set", "start=-100")
    assert status == 1
    assert "failed: fill(length=1, fill=strict): too far" in err
    assert "2 failed" in out
    assert Path("runs/toy/report.html").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--jobs", "0"], "jobs must be 1 or more, got 0"),
        (["--jobs", "many"], "invalid int value"),
        (["--executor", "serail"], "did you mean 'serial'"),
        (["--out", "toys.py"], "toys.py holds something that is not a run"),
        (["--out", "toys.py/x"], "cannot be written there"),
    ],
)
def test_a_run_that_cannot_begin_ends_with_2(command: Command, words: list[str], said: str) -> None:
    status, out, err = command("run", "toy.yaml", *words)
    assert (status, out) == (2, "")
    assert said in err
    assert "def number" in Path("toys.py").read_text()
