"""A saved run of toy nodes, and the pages of it."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import nodegraph as ng
from nodegraph.plugin import loading
from nodegraph.plugin.registry import Registry
from nodegraph.serve.app import application
from nodegraph.serve.guard import Guard
from nodegraph.serve.runs import OpenRuns
from tests.nodegraph.serve.requests import HOST, ORIGIN, Answer, send

NODES = """\
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

from nodegraph import (
    Across, Detail, Fact, Refusal, Rendered, Kind, Value, Viewer, hookimpl, node
)

SCRIPT = '''
nodegraph.define("toy/table", ["server"], async (server) => {
  const block = { node: "table", compare: "fill", methods: ["hold"], block: { start: 5 } };
  window.packed = server && await server.get("detail", block);
});
'''

@dataclass(frozen=True)
class Text(Value):
    text: str

@dataclass(frozen=True)
class Score(Value):
    error: float

@node("toy.number")
def number(*, start: float = 1.0) -> float:
    return start

@node("fill.hold")
def hold(x: float) -> float:
    return x + 1

@node("fill.strict")
def strict(x: float) -> float:
    if x > 4:
        raise Refusal("too large")
    return x

@node("toy.score")
def score(estimate: float, truth: float) -> Score:
    return Score(estimate - truth)

@node("toy.table")
def table(scores: Across[Score]) -> Text:
    rows = "; ".join(f"{at}: {each.error}" for at, each in scores)
    return Text(f"<script>bad()</script> {rows}")

def pack(block, inputs):
    return {"block": block, "inputs": inputs}

def view(values):
    ((label, score),) = values.items()
    if score.error:
        raise Refusal("not exact")
    return Rendered(f"<b>{escape(label)} is exact</b>", scripts=("seen();",))

@hookimpl
def nodegraph_viewers() -> Iterable[Viewer]:
    return [Viewer((Score,), view)]

@hookimpl
def nodegraph_kinds() -> Iterable[Kind]:
    return [
        Kind(Text, lambda value, title: Rendered(escape(value.text), scripts=(SCRIPT,))),
        Kind(
            float,
            facts=lambda value: [Fact("size", value, "mm"), Fact("names", ["p", "q"])],
            detail=lambda: Detail(pack, lambda inputs, column: None, "toy/view"),
        ),
    ]
"""
GRAPH = """\
nodegraph: 1
title: <script>bad()</script>
axes: {start: [1, 5]}
nodes:
  a: {use: toy.number, with: {start: $start}}
  fill: {in: a, alternatives: {hold: {use: fill.hold}, "<u>": {use: fill.strict}}}
  error: {use: toy.score, in: {estimate: fill, truth: a}}
  table: {use: toy.table, in: error}
report: [table]
"""


@pytest.fixture(scope="session")
def whole_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which everything lies: nodes, graph, store, and a run."""
    folder = tmp_path_factory.mktemp("open")
    (folder / "toys.py").write_text(NODES)
    (folder / "toy.yaml").write_text(GRAPH)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(loading, "installed", lambda: ([], []))
        patch.chdir(folder)
        graph = ng.load("toy.yaml", plugins=["toys.py"])
        ng.run(graph, store="store").save("runs/toy")
    return folder


@pytest.fixture
def folder(whole_run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of that folder, which is the working directory; nothing else is installed."""
    monkeypatch.setattr(loading, "installed", lambda: ([], []))
    shutil.copytree(whole_run, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


class Pages:
    """The pages of runs, as the browser gets them that has opened the printed address."""

    def __init__(self, *runs: str, plugins: tuple[str, ...] = ("toys.py",)) -> None:
        registry = Registry.installed([Path(name) for name in plugins])
        paths = map(Path, runs or ("runs/toy",))
        self._guard = Guard(application(OpenRuns(paths, registry, Path("store"))), HOST)
        answer = send(self._guard, f"/?token={self._guard.token}")
        self._cookie = answer.headers["set-cookie"].partition(";")[0]

    def get(self, target: str) -> Answer:
        return send(self._guard, target, cookie=self._cookie)

    def post(self, body: bytes, *, leave: bool = False) -> Answer:
        return send(
            self._guard,
            "/compute",
            method="POST",
            body=body,
            leave=leave,
            cookie=self._cookie,
            origin=ORIGIN,
            content_type="application/json",
            content_length=str(len(body)),
        )


@pytest.fixture
def opened(folder: Path) -> Callable[..., Pages]:
    """Open runs, by default the one there is."""
    return Pages
