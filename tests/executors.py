"""Fixtures for tests of executors: studies whose nodes can be called in other processes."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import pytest

from nodegraph.api import reported
from nodegraph.execute.call import Call
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.results import Run
from nodegraph.execute.run import execute
from nodegraph.execute.schedule import Schedule
from nodegraph.graph import Choices, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

AWAY = Path(__file__).parent / "away.py"
SAME = """
axes: {seed: [1, 2], length: [3, 9]}
nodes:
  whole: {use: away.pair, with: {seed: $seed}}
  gaps: {use: away.cut, in: whole, with: {length: $length, at: [3, 20]}}
  fill: {in: gaps.kept, alternatives: {writes: away.writes, pass: {}}}
  error: {use: away.mean, in: fill, with: {power: 0.5}}
  table: {use: away.table, in: {scores: error, hidden: gaps.hidden}}
"""
"""Arrays in both orders, several outputs, steps that only hand on, that fail, that gather."""

SCRIPT = """
    import sys
    from pathlib import Path
    from nodegraph import node
    from nodegraph.execute.executor import HowToRun
    from nodegraph.execute.run import execute
    from nodegraph.graph import Choices, build
    from nodegraph.plan import plan
    from nodegraph.plugin.registry import Registry
    from nodegraph.graphfile import read_graph_text

    @node("script.own")
    def own(x: int) -> int:
        return x

    registry = Registry.installed([Path(sys.argv[1])])
    registry._add_nodes("script", "", [own])
    spec = read_graph_text(sys.argv[2], "script.yaml", Path.cwd())
    how = HowToRun(sys.argv[3], 1)
    run = execute(plan(build(spec, registry, Choices())), how=how, keep=["b"])
    print(run.counts()["done"])
"""
"""A script without ``if __name__ == "__main__":``."""


@pytest.fixture(scope="session")
def registry() -> Registry:
    """The nodes of ``away.py``, imported once: only then is each of its classes one class."""
    return Registry.installed([AWAY])


@pytest.fixture
def away() -> Path:
    """The file of nodes that can be called anywhere."""
    return AWAY


@pytest.fixture
def study(registry: Registry, tmp_path: Path) -> Callable[..., Run]:
    """Run a graph of the nodes of ``away.py``, or of another registry."""

    def run_it(
        text: str,
        how: HowToRun,
        *,
        nodes: Registry = registry,
        listeners: Iterable[Any] = (),
        **inputs: object,
    ) -> Run:
        spec = read_graph_text(f"nodegraph: 1\n{textwrap.dedent(text)}", "away.yaml", tmp_path)
        graph = build(spec, nodes, Choices(inputs, folder=tmp_path))
        return execute(plan(graph), how=how, keep=reported(graph), listeners=listeners)

    return run_it


@pytest.fixture
def same_as_serial(study: Callable[..., Run]) -> Callable[[HowToRun], bool]:
    """Whether a way of running gives what one step after the other gives, to the bit."""

    def compare(how: HowToRun) -> bool:
        here, there = study(SAME, HowToRun("serial")), study(SAME, how)
        assert there.counts() == here.counts()
        assert here.counts()["failed"] == 4
        return bool(there["table"].value == here["table"].value)

    return compare


@pytest.fixture
def made_here(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the nodes that are called in this process."""
    called: list[str] = []
    perform = Schedule.perform

    def note(schedule: Schedule, call: Call) -> Outcome:
        called.append(call.node.name)
        return perform(schedule, call)

    monkeypatch.setattr(Schedule, "perform", note)
    return called


@pytest.fixture
def script(tmp_path: Path, away: Path) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Start a user's script that runs a graph."""
    started: list[subprocess.Popen[str]] = []

    def start(nodes: str, executor: str) -> subprocess.Popen[str]:
        file = tmp_path / "script.py"
        file.write_text(textwrap.dedent(SCRIPT))
        process = subprocess.Popen(
            [sys.executable, str(file), str(away), f"nodegraph: 1\nnodes: {nodes}", executor],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=tmp_path,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        process.kill()
        process.communicate()


@pytest.fixture
def fifo(tmp_path: Path) -> Callable[[str], Path]:
    """Make a named pipe: a process that opens it waits for the other side, and notices its end."""

    def make(name: str) -> Path:
        path = tmp_path / name
        os.mkfifo(path)
        return path

    return make


def reason(run: Run, node: str) -> str:
    """Return why the only step of a node has no value."""
    (matching,) = (outcome for step, outcome in run.settled() if step.node == node)
    return matching.reason


@pytest.fixture
def listen() -> Callable[[Path, subprocess.Popen[str]], IO[str]]:
    """Open a named pipe that a script opens, or that nobody opens because it has ended."""

    def open_it(path: Path, process: subprocess.Popen[str]) -> IO[str]:
        def end() -> None:
            process.wait()
            with suppress(OSError):
                os.close(os.open(path, os.O_WRONLY | os.O_NONBLOCK))

        threading.Thread(target=end, daemon=True).start()
        return open(path)

    return open_it
