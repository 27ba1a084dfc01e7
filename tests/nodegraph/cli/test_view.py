"""``view`` reads files before it serves anything; the page is tested beside the server."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import READER, Command


def test_help_has_an_example(command: Command) -> None:
    status, out, _ = command("view", "--help", nodes=False)
    assert status == 0
    assert "nodegraph view take.c3d" in out


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("nowhere.count", "nowhere.count: no such file"),
        ("damaged.count", "damaged.count:1: there is nothing"),
        ("toys.py", "toys.py: no node reads it"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(command: Command, name: str, message: str) -> None:
    Path("reader.py").write_text(READER)
    Path("good.count").write_text("count:3")
    Path("damaged.count").write_text("count:0")
    words = ("good.count", name, "--no-browser", "--plugin", "reader.py")
    status, out, err = command("view", *words)
    assert (status, out) == (2, "")
    assert message in err
