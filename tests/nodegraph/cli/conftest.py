"""A graph of toy nodes in a new folder, and a way to give commands there."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nodegraph.cli.main import main
from nodegraph.plugin import loading

NODES = """\
from typing import Annotated, NamedTuple
from pydantic import Field
from nodegraph import Across, Refusal, Truth, Unit, node

class Cut(NamedTuple):
    gappy: float
    truth: Truth[float]

@node("toy.number")
def number(*, start: float = 1.0) -> float:
    '''Give a number.'''
    return start

@node("toy.cut")
def cut(x: float, *, length: Annotated[int, Field(ge=1), Unit("frames")] = 3) -> Cut:
    '''Cut a gap.

    Parameters
    ----------
    length
        Of the gap.
    '''
    return Cut(x - length, x)

@node("fill.hold", cite="hold2001", lookahead=0, ends=False)
def hold(x: float) -> float:
    '''Hold on.'''
    return x

@node("fill.strict")
def strict(x: float) -> float:
    if x < -90:
        raise ValueError("too far")
    if x < -9:
        raise Refusal("too small")
    return x

@node("toy.sum")
def total(parts: Across[float]) -> float:
    return sum(parts.values())
"""
GRAPH = """\
nodegraph: 1
title: A toy
inputs: {start: 5}
axes: {length: [1, 5]}
nodes:
  a: {use: toy.number, with: {start: $start}}
  gaps: {use: toy.cut, in: a, with: {length: $length}}
  fill: {in: gaps, alternatives: fill.*}
  total: {use: toy.sum, in: fill}
  one: {use: fill.hold, in: {from: gaps, at: {length: 5}}}
"""
READER = """
from pathlib import Path
from typing import Annotated
import warnings
from pydantic import Field
from nodegraph import Fact, InputFile, Kind, hookimpl, node

@node("read.count")
def count(*, path: InputFile, times: Annotated[int, Field(ge=1)] = 1) -> int:
    if not (number := int(Path(path).read_text().split(":")[1])):
        raise ValueError(f"{path}:1: there is nothing; set `times`")
    warnings.warn(f"{path}: it states no unit")
    return times * number

@hookimpl
def nodegraph_readers():
    return {"read.count": lambda path: "Count" if path.suffix == ".count" else None}

@hookimpl
def nodegraph_places():
    return {"toy": Path}

def facts(number):
    yield Fact("number", number, "things")
    yield Fact("names", ["one", "two"])
    yield Fact("nothing", [])
    yield Fact("parts", {"half": {"size": number / 2}})

@hookimpl
def nodegraph_kinds():
    return [Kind(int, facts=facts)]
"""
"""A plugin with a node that reads files."""

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def _alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[None]:
    """Nothing is installed, and the working directory is a new one with a graph and its nodes."""
    monkeypatch.setattr(loading, "installed", lambda: ([], []))
    monkeypatch.chdir(tmp_path)
    Path("toys.py").write_text(NODES)
    Path("toy.yaml").write_text(GRAPH)
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", "")).startswith(str(tmp_path)):
            del sys.modules[name]


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Command:
    """Run one command with the toy nodes; return exit status, output and errors."""

    def call(*words: str, nodes: bool = True) -> tuple[int, str, str]:
        try:
            status = main([*words, *(["--plugin", "toys.py"] if nodes else [])])
        except SystemExit as stop:
            status = int(stop.code or 0)
        out, err = capsys.readouterr()
        assert "Traceback" not in err
        return status, out, err

    return call
