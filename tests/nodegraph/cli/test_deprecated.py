"""Commands tell what is deprecated: lists, descriptions, and every use in a graph."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.nodegraph.cli.conftest import Command

NODES = """
from typing import Annotated
from nodegraph import Deprecated, node

@node("toy.old", deprecated="use toy.number")
def old(*, begin: Annotated[float, Deprecated("use start")] = 1.0) -> float:
    '''Give an old number.

    Parameters
    ----------
    begin
        The number.
    '''
    return begin
"""


@pytest.fixture(autouse=True)
def _old() -> None:
    Path("toys.py").write_text(Path("toys.py").read_text() + NODES)
    Path("toy.yaml").write_text("nodegraph: 1\nnodes:\n  a: {use: toy.old, with: {begin: 2}}\n")


def test_lists_and_descriptions(command: Command) -> None:
    assert "(deprecated: use toy.number) Give an old number." in command("show", "toy")[1]
    _, out, _ = command("show", "toy.old")
    assert "toy.old    plugin toys\n\ndeprecated: use toy.number\n" in out
    assert "(deprecated: use start) The number." in out


@pytest.mark.parametrize("words", [("check",), ("run", "--out", "made", "--no-cache")])
def test_a_graph_that_uses_it(command: Command, words: tuple[str, ...]) -> None:
    status, _, err = command(words[0], "toy.yaml", *words[1:])
    assert status == 0
    assert "toy.yaml:3:12: a: toy.old is deprecated\n    use toy.number\n" in err
    assert "toy.yaml:3:35: a: setting 'begin' of toy.old is deprecated\n    use start\n" in err


def test_the_report_and_the_schema(command: Command) -> None:
    command("run", "toy.yaml", "--out", "made", "--no-cache")
    assert "a: toy.old is deprecated: use toy.number" in Path("made/report.html").read_text()
    command("schema", "--out", "schema.json")
    names = json.loads(Path("schema.json").read_text())["$defs"]["node name"]["oneOf"]
    assert [name["const"] for name in names if name.get("deprecated")] == ["toy.old"]
