from __future__ import annotations

import pytest

from nodegraph.execute import Event
from nodegraph.terminal import columns, progress, settled_line


def run(listener: object, states: list[str]) -> None:
    assert callable(listener)
    listener(Event("planned", 0.0, detail={"steps": len(states), "nodes": 2}))
    for number, state in enumerate(states):
        listener(Event("started", 0.1, number, "fill", {"k": number}))
        listener(Event(state, 0.2, number, "fill", {"k": number}, {"reason": "no frame"}))
    listener(Event("finished", 0.3))


def test_plain_lines_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress() as listener:
        run(listener, ["done"] * 98 + ["failed", "refused"])
    out, err = capsys.readouterr()
    lines = err.splitlines()
    assert out == ""
    assert lines[0] == "100 steps of 2 nodes"
    assert lines[1] == "10 of 100 steps, 0.2 s"
    assert lines[-3:] == [
        "failed: fill(k=98): no frame",
        "refused: fill(k=99): no frame",
        "100 of 100 steps, 0.2 s",
    ]
    assert len(lines) == 13


def test_a_run_of_no_steps_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    with progress() as listener:
        run(listener, [])
    assert capsys.readouterr().err == "0 steps of 2 nodes\n"


def test_a_bar_in_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    with progress() as listener:
        run(listener, ["done", "failed", "skipped", "refused"])
    err = capsys.readouterr().err
    assert "failed: fill(k=1): no frame" in err
    assert "refused: fill(k=3): no frame" in err


def test_a_step_without_labels_is_its_node() -> None:
    assert settled_line(Event("failed", 0.0, 1, "table")) == "failed: table: "


def test_columns_are_aligned() -> None:
    assert columns([("a", "bb"), ("ccc", "d")]) == "a    bb\nccc  d"
    assert columns([]) == ""
