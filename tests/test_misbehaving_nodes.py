"""Nodes that do what they should not: each is named, and the rest of the run continues."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from tests.records import read_record
from tests.studies import ROOT, command

NODES = """\
import ctypes, os, subprocess, sys, tempfile, threading, time, warnings
from pathlib import Path
import numpy as np
from nodegraph import node

@node("bad.make")
def make(*, size: int = 1000) -> np.ndarray:
    return np.arange(float(size))

@node("bad.type")
def wrong_type(x: np.ndarray) -> float:
    return "a text"

@node("bad.mutates")
def mutates(x: np.ndarray) -> float:
    x[0] = 99.0
    return 1.0

@node("bad.raises")
def raises(x: np.ndarray) -> float:
    return {}["chin"]

@node("bad.exits")
def exits(x: np.ndarray) -> float:
    sys.exit("enough")

@node("bad.interrupts")
def interrupts(x: np.ndarray) -> float:
    raise KeyboardInterrupt("enough")

@node("bad.ends")
def ends(x: np.ndarray) -> float:
    os._exit(0)

@node("bad.threads")
def threads(x: np.ndarray) -> float:
    threading.Thread(target=lambda: time.sleep(10), name="late", daemon=True).start()
    return 1.0

@node("bad.forks_in_c")
def forks_in_c(x: np.ndarray) -> float:
    # which takes Python's lock meanwhile: the new process, which has no such thread, waits for it
    busy = threading.Thread(target=sum, args=(range(10**7),))
    busy.start()
    ctypes.CDLL(None).fork()
    busy.join()
    return 1.0

@node("bad.forgets")
def forgets(x: np.ndarray) -> float:
    sys.path.clear()
    return 1.0

@node("bad.changes")
def changes(x: np.ndarray) -> float:
    os.chdir(tempfile.mkdtemp())
    os.rmdir(os.getcwd())
    os.environ["CHANGED"] = "1"
    np.random.seed(1)
    np.seterr(all="raise")
    warnings.simplefilter("ignore")
    sys.setrecursionlimit(200)
    for number in range(3):
        os.close(number)
    sys.stderr.close()
    return 1.0

@node("good.looks")
def looks(x: np.ndarray, after: float) -> float:
    assert "CHANGED" not in os.environ
    warnings.warn(f"seen in {os.path.basename(os.getcwd())}")
    return 1.0

@node("bad.starts")
def starts(x: np.ndarray, *, sign: str) -> float:
    Path(sign).write_text(str(subprocess.Popen(["sleep", "1000"]).pid))
    return 1.0

@node("bad.thread_stays")
def thread_stays(x: np.ndarray) -> float:
    # as a library would start it
    start = "threading.Thread(target=time.sleep, args=(100,)).start()"
    exec(start, {**globals(), "__name__": "other"})
    return 1.0

@node("bad.holds")
def holds(x: np.ndarray, *, sign: str = "") -> float:
    sys.setswitchinterval(1000)
    if sign:
        ctypes.PyDLL(None).creat(sign.encode(), 0o600)  # and the lock is not released meanwhile
    ctypes.PyDLL(None).sleep(100)
    return 1.0

@node("bad.segfaults")
def segfaults(x: np.ndarray) -> float:
    return float(len(ctypes.string_at(0)))

@node("bad.dies")
def dies(x: np.ndarray) -> float:
    ctypes.CDLL(None).exit(0)

@node("bad.dies_at_once")
def dies_at_once(x: np.ndarray) -> float:
    ctypes.CDLL(None)._exit(0)

@node("bad.kills")
def kills(x: np.ndarray) -> float:
    os.kill(os.getpid(), 9)

@node("bad.sleeps")
def sleeps(x: np.ndarray, *, sign: str) -> float:
    Path(sign).write_text("asleep")
    while True:
        time.sleep(1)

@node("bad.hangs", timeout=0.2)
def hangs(x: np.ndarray) -> float:
    while True:
        time.sleep(1)

@node("bad.grows")
def grows(x: np.ndarray) -> float:
    return float(np.ones(10**9).sum())

@node("good.sum")
def good(x: np.ndarray) -> float:
    return float(x.sum())
"""
GRAPH = """\
nodegraph: 1
nodes:
  make: {use: bad.make}
  bad: {in: make, alternatives: [BAD, good.sum]}
"""


PROGRAM = """\
from nodegraph.cli import ending
from nodegraph.cli.main import program
ending._SECONDS_TO_END = 1.0
program()
"""
"""The program, which waits for less long than others do for threads that nodes have left."""


def words_for(folder: Path, *words: str) -> list[str]:
    (folder / "nodes.py").write_text(NODES)
    graph = str(folder / "bad.yaml")
    return [
        "run",
        graph,
        "--plugin",
        str(folder / "nodes.py"),
        "--out",
        str(folder / "out"),
        *words,
    ]


def started(out: Path, *words: str, folder: Path | None = None) -> subprocess.Popen[str]:
    """Start the program."""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *words_for(out, *words)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), str(ROOT / "plugins")])},
        stderr=subprocess.PIPE,
        text=True,
    )


def record_of(folder: Path, bad: str, *words: str) -> dict[str, Any]:
    """Run the graph with one bad node; return the record."""
    (folder / "bad.yaml").write_text(GRAPH.replace("BAD", bad))
    assert command(*words_for(folder, *words), folder=folder).status == 1
    return read_record(folder / "out")


BAD = {
    "bad.type": "TypeError: bad.type returned str where its signature promises float (output)",
    "bad.mutates": "it modifies its input; copy it before writing: assignment destination is "
    "read-only",
    "bad.raises": "KeyError: 'chin'",
    "bad.exits": "SystemExit: enough",
    "bad.interrupts": "KeyboardInterrupt: enough",
    "bad.ends": "RuntimeError: a step cannot end the process, with status 0",
    "bad.threads": "RuntimeError: it has returned while its thread late still runs",
    "bad.hangs": "it takes longer than 0.2 s, which is the limit",
}
ENDS = {
    "bad.dies": "the process that computed it ended with exit status 0",
    "bad.kills": "the process that computed it was ended by signal SIGKILL (out of memory?)",
    "bad.segfaults": "the process that computed it was ended by signal SIGSEGV",
    "bad.holds": "it takes longer than 2 s, which is the limit",
}
"""Those that end or hold the process that they run in."""
JOBS = {"serial": "1", "threads": "2", "processes": "1", "dask": "1"}
"""The fewest with which each executor is itself: a single thread would be that of the run."""


def check_failures(record: dict[str, Any], expected: dict[str, str]) -> None:
    """Check that these nodes have failed, for these reasons, and nothing else."""
    assert record["counts"] == {**record["counts"], "done": 2, "failed": len(expected)}
    failed = {step["use"]: step["reason"] for step in record["steps"] if step["state"] == "failed"}
    assert failed == expected


@pytest.mark.parametrize("executor", JOBS)
def test_a_bad_node_fails_alone(tmp_path: Path, executor: str) -> None:
    # a node's own limit of time is the shorter one
    words = ("--executor", executor, "--jobs", JOBS[executor], "--timeout", "60")
    record = record_of(tmp_path, ", ".join(BAD), *words)
    check_failures(record, BAD)


def test_a_node_that_only_a_process_holds_fails_alone(tmp_path: Path) -> None:
    # with a timeout, steps run in processes
    record = record_of(tmp_path, ", ".join(ENDS), "--timeout", "2", "--jobs", "1")
    check_failures(record, ENDS)


def test_processes_that_a_node_leaves_end_with_the_run(tmp_path: Path) -> None:
    sign = tmp_path / "sign"
    bad = f"{{bad: {{use: bad.starts, with: {{sign: {sign}}}}}, good: {{use: good.sum}}}}"
    (tmp_path / "bad.yaml").write_text(GRAPH.replace("[BAD, good.sum]", bad))
    words = words_for(tmp_path, "--executor", "processes", "--jobs", JOBS["processes"])
    assert command(*words, folder=tmp_path).status == 0
    state = Path("/proc", sign.read_text(), "stat")
    with suppress(FileNotFoundError):
        while state.read_text().split()[2] != "Z":  # a process ends some time after the signal
            time.sleep(0.01)


def test_nodes_that_spoil_their_process_spoil_nothing_else(tmp_path: Path) -> None:
    bad = "bad.forks_in_c, bad.forgets, bad.thread_stays"
    processes = {}
    for executor in ("serial", "threads", "processes"):
        folder = tmp_path / executor
        folder.mkdir()
        (folder / "bad.yaml").write_text(GRAPH.replace("BAD", bad))
        words = ("--executor", executor, "--jobs", JOBS[executor], "--store", str(folder / "store"))
        processes[executor] = started(folder, *words)
    for executor, process in processes.items():
        _, errors = process.communicate(timeout=60)
        assert process.returncode == 0, (executor, errors)
        out = tmp_path / executor / "out"
        record = read_record(out)
        assert (record["counts"]["done"], (out / "report.html").is_file()) == (5, True), executor
        assert [text for step in record["steps"] for text in step.get("warnings", ())] == [
            "it changes sys.path, which is put back: import from installed packages"
        ], executor


CHANGED = {
    "draws from the global random state",
    "changes numpy's treatment of errors",
    "changes os.environ",
    "changes the working directory",
    "changes the limit of recursion",
    "closes or replaces standard streams",
    "changes the filters of warnings",
}


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_what_a_node_changes_is_put_back_and_named(tmp_path: Path, executor: str) -> None:
    (tmp_path / "bad.yaml").write_text(
        "nodegraph: 1\nnodes:\n  make: {use: bad.make}\n  bad: {in: make, use: bad.changes}\n"
        "  good: {in: {x: make, after: bad}, use: good.looks}\n"
    )
    process = started(tmp_path, "--executor", executor, "--jobs", "1", folder=tmp_path)
    _, errors = process.communicate(timeout=60)
    assert (process.returncode, "finished after" in errors) == (0, True), errors
    warned = {
        step["node"]: step.get("warnings", []) for step in read_record(tmp_path / "out")["steps"]
    }
    assert {text.removeprefix("it ").partition(",")[0] for text in warned["bad"]} == CHANGED
    assert warned["good"] == [f"seen in {tmp_path.name}"]


def test_what_a_thread_cannot_do_is_said_first(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text(GRAPH.replace("BAD, ", ""))
    words = words_for(tmp_path, "--executor", "threads", "--timeout", "9")
    ended = command(*words, folder=tmp_path)
    assert ended.status == 0
    assert ended.err.startswith("executor 'threads' cannot end a step that takes too long: ")


@pytest.mark.skipif(sys.platform != "linux", reason="the limit needs Linux")
def test_a_node_that_takes_too_much_memory_fails_alone(tmp_path: Path) -> None:
    words = ("--executor", "processes", "--jobs", "1", "--memory", "1")
    record = record_of(tmp_path, "bad.grows", *words)
    [failed] = (step for step in record["steps"] if step["state"] == "failed")
    assert failed["use"] == "bad.grows"
    assert "Unable to allocate 7.45 GiB" in failed["reason"]
    assert record["counts"]["done"] == 2


def test_memory_that_cannot_be_limited_is_refused(tmp_path: Path) -> None:
    (tmp_path / "bad.yaml").write_text(GRAPH.replace("BAD", "bad.grows"))
    ended = command(*words_for(tmp_path, "--executor", "dask", "--memory", "1"), folder=tmp_path)
    assert ended.status == 2
    assert "memory cannot be limited with executor 'dask'" in ended.err


@pytest.mark.parametrize(
    ("bad", "status", "how"),
    [
        ("bad.dies_at_once", 1, "has ended with exit status 0"),
        ("bad.segfaults", -signal.SIGSEGV, "was ended by signal SIGSEGV"),
    ],
)
def test_a_node_that_ends_the_program_loses_nothing_that_was_finished(
    tmp_path: Path, bad: str, status: int, how: str
) -> None:
    (tmp_path / "bad.yaml").write_text(GRAPH.replace("BAD, good.sum", f"good.sum, {bad}"))
    process = started(tmp_path, "--executor", "serial")
    _, errors = process.communicate(timeout=60)
    assert process.returncode == status
    assert f"the process {how} before the run was finished, while {bad} ran" in errors
    plugin = ("--plugin", str(tmp_path / "nodes.py"))
    checked = command("check", str(tmp_path / "bad.yaml"), *plugin, folder=tmp_path)
    assert checked.out.endswith("3 steps, 2 of them stored\n")


CONTINUES = "the same command continues from there"
LET_GO = "ended with a step that does not let go; finished steps are stored"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_program_that_is_ended_ends_whole(tmp_path: Path, number: signal.Signals) -> None:
    sign = tmp_path / "sign"
    bad = f"{{bad: {{use: bad.sleeps, with: {{sign: {sign}}}}}}}"
    (tmp_path / "bad.yaml").write_text(GRAPH.replace("[BAD, good.sum]", bad))
    process = started(tmp_path)
    while not sign.exists():
        assert process.poll() is None, process.stderr and process.stderr.read()
        time.sleep(0.01)
    process.send_signal(number)
    process.communicate(timeout=60)  # whatever was left of it would keep the pipe open
    assert process.returncode == -number


NEVER_RETURN = [
    ("threads", "bad.sleeps", CONTINUES),
    ("serial", "bad.holds", CONTINUES),
    ("threads", "bad.holds", LET_GO),
    ("processes", "bad.holds", CONTINUES),
    ("dask", "bad.holds", CONTINUES),
]


def test_nodes_that_never_return_are_interrupted(tmp_path: Path) -> None:
    processes = []
    for number, (executor, bad, _) in enumerate(NEVER_RETURN):
        folder = tmp_path / str(number)
        folder.mkdir()
        with_sign = f"{{use: {bad}, with: {{sign: {folder / 'sign'}}}}}"
        nodes = f"{{make: {{use: good.sum}}, bad: {with_sign}}}"
        (folder / "bad.yaml").write_text(GRAPH.replace("[BAD, good.sum]", nodes))
        words = ("--executor", executor, "--jobs", JOBS[executor], "--store", str(folder / "store"))
        processes.append(started(folder, *words))
    for number, process in enumerate(processes):
        while not (tmp_path / str(number) / "sign").exists():
            assert process.poll() is None, process.stderr and process.stderr.read()
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
    for number, (process, case) in enumerate(zip(processes, NEVER_RETURN, strict=True)):
        _, errors = process.communicate(timeout=60)
        assert (process.returncode, case[-1] in errors) == (130, True), (case, errors)
        events = (tmp_path / str(number) / "out" / "events.jsonl").read_text().splitlines()
        assert [json.loads(line)["event"] for line in events].count("done") >= 1, case
