from __future__ import annotations

import os
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import pytest

from nodegraph import NodegraphError, node
from nodegraph.execute import processes
from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run

TWO = HowToRun("processes", 2)
ONE = HowToRun("processes", 1)


def outcomes(run: Run) -> dict[str, Any]:
    return {step.node: outcome for step, outcome in run.settled()}


def has_ended(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


def test_results_are_those_of_the_serial_executor(
    same_as_serial: Callable[[HowToRun], bool], made_here: list[str]
) -> None:
    assert same_as_serial(TWO)
    # once by each way of running
    assert made_here.count("pass") == 2 * 4
    assert made_here.count("away.mean") == 4


def test_two_calls_are_made_at_the_same_time_by_no_more_processes_than_jobs(
    study: Callable[..., Run], fifo: Callable[[str], Path]
) -> None:
    there, back = fifo("there"), fifo("back")
    text = """
        inputs: {there: "", back: ""}
        axes: {k: {count: 12}}
        nodes:
          x: {use: away.pid}
          a: {use: away.meets, in: x, with: {write: $there, read: $back, first: true}}
          b: {use: away.meets, in: x, with: {write: $back, read: $there, first: false}}
          pid: {use: away.pid, with: {mark: $k}}
        """
    run = study(text, TWO, there=str(there), back=str(back))
    assert (run["a"].value, run["b"].value) == (1, 1)
    pids = {value for _, value in run["pid"]}
    assert 1 <= len(pids) <= 2
    assert os.getpid() not in pids
    assert all(has_ended(pid) for pid in pids)


def test_no_more_processes_start_than_there_are_calls_at_a_time(study: Callable[..., Run]) -> None:
    text = "nodes: {a: {use: away.pid}, b: {use: away.warns, in: a}, c: {use: away.warns, in: b}}"
    run = study(text, HowToRun("processes", 4))
    assert run["c"].value != os.getpid()
    assert run.counts()["done"] == 3


@pytest.fixture
def killed_at_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Have the first so many worker processes killed before they are ready."""

    def kill(times: int) -> None:
        flag = tmp_path / "starts"
        flag.touch()
        count = (
            f"import os, pathlib; p = pathlib.Path({str(flag)!r}); p.open('a').write('x'); "
            f"len(p.read_text()) > {times} or os.kill(os.getpid(), 9); "
        )
        monkeypatch.setattr(processes, "_PROGRAM", count + processes._PROGRAM)

    return kill


def test_another_process_starts_for_one_that_was_killed_before_it_was_ready(
    study: Callable[..., Run], killed_at_start: Callable[[int], None]
) -> None:
    killed_at_start(2)
    run = study("nodes: {a: {use: away.pid}}", ONE)
    assert run["a"].value != os.getpid()


def test_processes_that_never_start_end_the_run(
    study: Callable[..., Run], killed_at_start: Callable[[int], None]
) -> None:
    killed_at_start(99)
    with pytest.raises(NodegraphError, match=r"does not start.*SIGKILL"):
        study("nodes: {a: {use: away.pid}}", ONE)


def test_a_value_that_cannot_be_sent_stays_here(study: Callable[..., Run]) -> None:
    text = """
        nodes:
          x: {use: away.pid}
          opaque: {use: away.opaque, in: x}
          list: {use: away.list, in: x}
          of_opaque: {use: away.known, in: opaque}
          of_list: {use: away.known_first, in: list}
        """
    run = study(text, ONE)
    assert run["of_opaque"].value == run["of_list"].value == os.getpid()


def test_a_node_that_cannot_be_imported_is_called_here(
    run_of: Callable[..., Run],
) -> None:
    @node("local.pid")
    def local(x: float) -> int:
        return os.getpid()

    text = "nodes: {a: {use: read.number}, b: {use: local.pid, in: a}}"
    assert run_of(text, more=[local], how=ONE)["b"].value == os.getpid()


def test_large_values_warnings_and_errors_come_back(study: Callable[..., Run]) -> None:
    text = """
        nodes:
          large: {use: away.pair, with: {rows: 60000}}
          cut: {use: away.cut, in: large}
          size: {use: away.size, in: cut.kept}
          x: {use: away.pid}
          pair: {use: away.pair}
          warns: {use: away.warns, in: x}
          refuses: {use: away.refuses, in: x}
          fails: {use: away.fails, in: x}
          lies: {use: away.lies, in: x}
          writes: {use: away.writes, in: pair}
        """
    runs = [study(text, how) for how in (HowToRun("serial"), ONE)]
    assert [run["size"].value for run in runs] == 2 * [60000 * 36 * 8]
    here, there = map(outcomes, runs)
    assert {name: outcome.state for name, outcome in there.items()} == {
        "large": "done", "cut": "done", "size": "done", "x": "done", "pair": "done",
        "warns": "done", "refuses": "refused", "fails": "failed", "lies": "failed",
        "writes": "failed",
    }  # fmt: skip
    assert {name: outcome.reason for name, outcome in there.items()} == {
        name: outcome.reason for name, outcome in here.items()
    }
    assert there["warns"].warnings == ("two of them are odd",)
    assert "away.py" in there["fails"].trace
    assert 'KeyError("no such marker")' in there["fails"].trace


def test_an_interruption_ends_a_node_that_never_returns(
    study: Callable[..., Run], fifo: Callable[[str], Path]
) -> None:
    alive = fifo("alive")
    text = """
        inputs: {alive: ""}
        nodes:
          x: {use: away.pid}
          a: {use: away.for_ever, in: x, with: {alive: $alive}}
          b: {use: away.warns, in: x}
        """
    pids: list[int] = []
    before = set(threading.enumerate())

    def interrupt(event: Event) -> None:
        if event.node == "b" and event.kind == "done":
            with open(alive) as opened:
                pids.append(int(opened.readline()))
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        study(text, TWO, listeners=[interrupt], alive=str(alive))
    assert has_ended(pids[0])
    assert set(threading.enumerate()) <= before


def test_a_script_without_a_guard_runs_once(script: Callable[..., subprocess.Popen[str]]) -> None:
    nodes = "{x: {use: away.pid}, a: {use: script.own, in: x}, b: {use: away.prints, in: a}}"
    output, complained = script(nodes, "processes").communicate(timeout=60)
    assert (output, complained) == ("3\n", "noise\n")


def test_processes_end_with_the_one_that_started_them(
    script: Callable[..., subprocess.Popen[str]],
    fifo: Callable[[str], Path],
    listen: Callable[..., IO[str]],
) -> None:
    alive = fifo("alive")
    nodes = f"{{x: {{use: away.pid}}, a: {{use: away.for_ever, in: x, with: {{alive: {alive}}}}}}}"
    parent = script(nodes, "processes")
    with listen(alive, parent) as opened:
        assert int(opened.readline()) != parent.pid
        parent.kill()
        parent.communicate()
        assert opened.read() == ""  # the end: nobody has it open any more
