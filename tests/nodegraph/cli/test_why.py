"""``why`` names which part of a key is not as it was."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command


def edit(file: str, old: str, new: str) -> None:
    """Change a file, some time before it is read again."""
    path = Path(file)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    status = path.stat()
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns - 5_000_000_000))


def test_unchanged_steps_are_stored(command: Command) -> None:
    command("run", "toy.yaml")
    status, out, err = command("check", "toy.yaml", "--why", "total")
    assert (status, err) == (0, "")
    assert out == "total: 1 of 1 steps are stored; compared with runs/toy\n"


@pytest.mark.parametrize(
    ("file", "old", "new", "text"),
    [
        ("toys.py", "Cut(x - length, x)", "Cut(x, x)", "toy.cut: code: toys was edited"),
        ("toy.yaml", "start: 5", "start: 6", "a: start was 5, now 6"),
    ],
)
def test_the_part_that_changed_is_named(
    command: Command, file: str, old: str, new: str, text: str
) -> None:
    command("run", "toy.yaml")
    edit(file, old, new)
    status, out, _ = command("check", "toy.yaml", "--why", "total")
    assert status == 0
    assert text in out


def test_another_file_and_other_content_are_distinguished(command: Command) -> None:
    edit("toys.py", "import Across", "import InputFile, Across")
    reader = "\n@node('toy.read')\ndef read(*, file: InputFile) -> float:\n    return 1.0\n"
    Path("toys.py").write_text(Path("toys.py").read_text() + reader)
    Path("one.txt").write_text("1")
    Path("two.txt").write_text("2")
    Path("read.yaml").write_text(
        "nodegraph: 1\ninputs: {file: one.txt}\nnodes: {a: {use: toy.read, with: {file: $file}}}"
    )
    command("run", "read.yaml")
    assert (
        "a: file was 'one.txt', now 'two.txt'"
        in command("check", "read.yaml", "--why", "a", "--set", "file=two.txt")[1]
    )
    edit("one.txt", "1", "3")
    assert (
        "a: file: the content of one.txt changed" in command("check", "read.yaml", "--why", "a")[1]
    )


def test_only_edited_code_is_a_change(command: Command) -> None:
    command("run", "toy.yaml")
    edit("toys.py", "raise Refusal", "raise  Refusal")  # not a word of it is another
    edit("toys.py", "'''Hold on.'''", "'''Hold on, whatever comes.'''")
    assert "4 of 4 steps are stored" in command("check", "toy.yaml", "--why", "fill")[1]
    edit("toys.py", "whatever comes.'''\n    return x", "whatever comes.'''\n    return -x")
    _, out, _ = command("check", "toy.yaml", "--why", "fill")
    assert out.startswith("fill: 0 of 4 steps are stored")
    assert "fill.hold: code: toys was edited" in out


def test_a_removed_result_is_not_in_the_store(command: Command) -> None:
    command("run", "toy.yaml")
    command("cache", "clear", nodes=False)
    _, out, _ = command("check", "toy.yaml", "--why", "total")
    assert "0 of 1 steps are stored" in out
    assert "the result is not in the store" in out


def test_an_earlier_run_is_needed(command: Command) -> None:
    status, out, err = command("check", "toy.yaml", "--why", "total")
    assert (status, out) == (2, "")
    assert "there is no finished run; run the graph" in err
    command("run", "toy.yaml", "--out", "elsewhere")
    assert command("check", "toy.yaml", "--why", "total", "--run", "elsewhere")[0] == 0
    status, _, err = command("check", "toy.yaml", "--why", "totla", "--run", "elsewhere")
    assert status == 2
    assert "did you mean 'total'" in err
    Path("elsewhere/run.json").write_text('{"format": 0, "steps": []}')
    status, _, err = command("check", "toy.yaml", "--why", "total", "--run", "elsewhere")
    assert status == 2
    assert "elsewhere/run.json is of format 0" in err
    Path("elsewhere/run.json").write_text("{")
    status, _, err = command("check", "toy.yaml", "--why", "total", "--run", "elsewhere")
    assert status == 2
    assert "elsewhere/run.json cannot be read" in err
