"""``draw`` writes a picture."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command


@pytest.mark.parametrize(
    ("words", "begins"),
    [
        ([], "<svg"),
        (["--format", "mermaid"], "flowchart"),
        (["--format", "dot"], "digraph"),
    ],
)
def test_a_graph_is_drawn(command: Command, words: list[str], begins: str) -> None:
    status, out, _ = command("draw", "toy.yaml", *words)
    assert status == 0
    assert begins in out[:200]


@pytest.mark.parametrize(
    ("name", "begins"), [("a.svg", "<svg"), ("a.mmd", "flowchart"), ("a.gv", "digraph")]
)
def test_a_drawing_is_written(command: Command, name: str, begins: str) -> None:
    path = Path("made/here", name)
    status, out, _ = command("draw", "toy.yaml", "-o", str(path))
    assert status == 0
    assert out.startswith(f"{path} (")
    assert begins in path.read_text(encoding="utf-8")[:200]


def test_a_drawing_is_written_as_pdf(command: Command) -> None:
    status, _, err = command("draw", "toy.yaml", "--out", "a.pdf")
    assert (status, err) == (0, "")
    assert Path("a.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--out", "a.bmp"], ".svg"),
        (["--out", "toys.py/a.svg"], "toys.py"),
        (["--format", "bmp"], "invalid choice"),
        (["--format", "pdf"], "--out"),
    ],
)
def test_a_drawing_that_cannot_be_written_is_an_error(
    command: Command, words: list[str], reason: str
) -> None:
    status, out, err = command("draw", "toy.yaml", *words)
    assert (status, out) == (2, "")
    assert reason in err


def test_a_terminal_is_not_filled_with_a_drawing(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    status, out, err = command("draw", "toy.yaml")
    assert (status, out) == (2, "")
    assert "--out toy.svg" in err
    assert command("draw", "toy.yaml", "--format", "dot")[0] == 0
