"""What holds for every executor, and executors of plugins."""

from __future__ import annotations

import ctypes
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nodegraph import NodegraphError, node
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.plugin.registry import Registry

WAYS = [HowToRun("serial"), HowToRun("threads", 1), HowToRun("threads", 4)]
TEXT = """
axes: {trial: {count: 4}, length: [5, 15]}
nodes:
  capture: {use: read.number, with: {start: 20}}
  gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
  fill: {in: gaps, alternatives: {hold: fill.hold, scale: fill.scale, pass: {}}}
  error: {use: score.gaps, in: {estimate: fill, truth: gaps.truth, hidden: gaps.hidden}}
  table: {use: compare.table, in: error}
"""
COUNTS = {"done": 58, "stored": 0, "refused": 0, "failed": 0, "skipped": 0, "unneeded": 0}
BARRIER = threading.Barrier(2, timeout=20)


@node("wait.together")
def together(x: float) -> float:
    """Return only when two of them run at the same time."""
    BARRIER.wait()
    return x


@node("array.make")
def make_array() -> np.ndarray:
    return np.ones(1000)


@node("array.spoil")
def spoil(x: np.ndarray, *, scales: list[float]) -> float:
    """Write past the lock of its input, and to a setting."""
    ctypes.memset(x.ctypes.data, 0, x.nbytes)
    scales.append(2.0)
    return float(x.sum())


@node("array.sum")
def sum_array(x: np.ndarray, *, scales: list[float]) -> float:
    return float(x.sum()) * sum(scales)


@pytest.mark.parametrize("how", WAYS)
def test_what_a_node_writes_past_a_lock_reaches_no_other_step(
    run_of: Callable[..., Run], how: HowToRun
) -> None:
    text = """
        nodes:
          a: {use: array.make}
          b: {in: a, with: {scales: [1.0]}, alternatives: [array.spoil, array.sum]}
    """
    run = run_of(text, more=[make_array, spoil, sum_array], how=how)
    assert {labels["b"]: value for labels, value in run["b"]} == {"spoil": 0.0, "sum": 1000.0}


@pytest.mark.parametrize("how", WAYS)
def test_every_way_of_running_gives_the_same(run_of: Callable[..., Run], how: HowToRun) -> None:
    here, there = run_of(TEXT), run_of(TEXT, how=how)
    assert there.counts() == here.counts() == COUNTS
    assert there["table"].value == here["table"].value
    assert list(there["fill"]) == list(here["fill"])


def test_independent_steps_run_at_the_same_time(run_of: Callable[..., Run]) -> None:
    text = """
        axes: {k: [1, 2]}
        nodes:
          a: {use: read.number, with: {start: $k}}
          b: {use: wait.together, in: a}
        """
    run = run_of(text, more=[together], how=HowToRun("threads", 2))
    assert run.counts()["done"] == 4


def test_steps_with_limits_run_in_processes() -> None:
    assert HowToRun().executor == "threads"
    assert HowToRun(timeout=1.0).executor == HowToRun(memory=1.0).executor == "processes"
    assert HowToRun("serial", timeout=1.0).executor == "serial"


PLUGIN = """
    from nodegraph import hookimpl, node
    from nodegraph.executors import perform

    CALLED = []

    @node("runners.number")
    def number(*, k: int = 0) -> int:
        return k

    def noting(schedule, how):
        while (call := schedule.next()) is not None:
            CALLED.append(how.executor)
            yield call.step, schedule.keep(call, perform(call))

    @hookimpl
    def nodegraph_executors():
        return {"noting": noting, "serial": noting}
    """


@pytest.fixture
def runners(tmp_path: Path) -> Path:
    """A plugin file with an executor of two names, one of which is taken."""
    path = tmp_path / "runners.py"
    path.write_text(textwrap.dedent(PLUGIN))
    return path


def test_a_plugin_adds_an_executor_but_replaces_none(
    study: Callable[..., Run], runners: Path
) -> None:
    registry = Registry.installed([runners])
    called = registry.loaded[-1].module.CALLED
    text = "axes: {k: [1, 2]}\nnodes: {a: {use: runners.number, with: {k: $k}}}"
    with pytest.warns(UserWarning, match="'runners': 'serial' of nodegraph_executors is left out"):
        run = study(text, HowToRun("noting"), nodes=registry)
    assert [value for _, value in run["a"]] == [1, 2]
    assert called == ["noting", "noting"]
    study(text, HowToRun("serial"), nodes=registry)
    assert called == ["noting", "noting"]


def test_the_name_of_the_built_in_plugin_is_taken(runners: Path) -> None:
    with pytest.raises(NodegraphError, match="'nodegraph' is already registered"):
        Registry.installed([runners.rename(runners.with_name("nodegraph.py"))])
