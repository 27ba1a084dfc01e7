"""Runs a study that is killed again and again, as a program of its own: it forks.

Prints one line of JSON: how often it was killed, what was computed more than once after it was
done, and whether the results are those of an undisturbed run.

``killed.py FOLDER SEED EXECUTOR [once]``; with ``once``, it is run once and not killed.
"""

from __future__ import annotations

import json
import os
import random
import signal
import sys
import time
from pathlib import Path

import numpy as np

from nodegraph import Across, node
from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.execute.resume import open_store
from nodegraph.execute.run import execute
from nodegraph.graph import Choices, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

KILLS = {"serial": 20, "threads": 50, "processes": 20, "dask": 8}
"""By executor: other processes take longer to start."""
GRAPH = """
nodegraph: 1
axes: {trial: {count: 60}, gain: [1, 2, 3]}
nodes:
  noise: {use: work.noise, with: {seed: $trial}}
  louder: {use: work.gain, in: noise, with: {gain: $gain}}
  level: {use: work.level, in: louder}
  total: {use: work.total, in: level}
"""
LOG = -1


def note(*words: object) -> None:
    """Append a line at once, whole, to what outlives this process."""
    if LOG >= 0:
        os.write(LOG, (" ".join(map(str, words)) + "\n").encode())


@node("work.noise")
def noise(*, seed: int) -> np.ndarray:
    """Make an array that is too large to stand in the entry itself."""
    time.sleep(0.004)
    return np.random.default_rng(seed).normal(size=(400, 3))


@node("work.gain")
def gain(x: np.ndarray, *, gain: int) -> np.ndarray:
    """Multiply."""
    time.sleep(0.004)
    return x * gain


@node("work.level")
def level(x: np.ndarray) -> float:
    """Sum."""
    return float(np.abs(x).sum())


@node("work.total")
def total(parts: Across[float]) -> float:
    """Sum over all."""
    return sum(parts.values())


def study(folder: Path, executor: str) -> Run:
    """Run, and note which steps are started and done."""
    # as a plugin file, the nodes go along to other processes
    registry = Registry.installed([Path(__file__)])
    graph = build(read_graph_text(GRAPH, "killed.yaml", folder), registry, Choices())
    steps = plan(graph)

    def note_end(event: Event) -> None:
        if event.kind == "done":
            note("done", event.step)
        elif event.kind == "started":
            note("step", event.step)

    store = open_store(registry, folder, lambda text: note("reported", text))
    return execute(steps, how=HowToRun(executor), store=store, keep=["total"], listeners=[note_end])


def wait_for_more(log: Path, child: int) -> None:
    """Wait until something more is done, or the child has ended."""
    before = log.read_text().count("done")
    while log.read_text().count("done") == before and not os.waitid(
        os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT
    ):
        time.sleep(0.001)


def killed_at_random(folder: Path, log: Path, seed: int, executor: str) -> int:
    """Start the study and kill it, until it was killed often enough."""
    chance = random.Random(seed)
    for _ in range(KILLS[executor]):
        child = os.fork()
        if not child:
            study(folder, executor)
            os._exit(0)
        if chance.random() < 0.5:  # else it may be killed before it has done anything
            wait_for_more(log, child)
        time.sleep(chance.uniform(0.0, 0.03))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    return KILLS[executor]


def computed_twice(log: Path) -> list[int]:
    """Return steps that were started after they were done."""
    finished: set[int] = set()
    twice: list[int] = []
    for line in log.read_text().splitlines():
        word, *rest = line.split()
        if word == "done":
            finished.add(int(rest[0]))
        elif word == "step" and int(rest[0]) in finished:
            twice.append(int(rest[0]))
    return twice


def main(folder: Path, seed: int, executor: str) -> None:
    """Kill, resume, and compare."""
    global LOG
    undisturbed = study(folder / "undisturbed", "serial")  # imports what each child needs
    log = folder / "log"
    LOG = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    kills = killed_at_random(folder / "killed", log, seed, executor)
    before = log.read_text().count("done")
    resumed = study(folder / "killed", executor)
    whole = log.read_text()
    LOG = -1
    same = [resumed.outcomes[i].digests == undisturbed.outcomes[i].digests for i in range(421)]
    print(
        json.dumps(
            {
                "kills": kills,
                "done before the last run": before,
                "computed then": resumed.counts()["done"],
                "twice": computed_twice(log),
                "reported": [line for line in whole.splitlines() if line.startswith("reported")],
                "same": all(same) and resumed["total"].value == undisturbed["total"].value,
            }
        )
    )


if __name__ == "__main__":
    words = sys.argv[1:]
    if words[3:] == ["once"]:
        print(json.dumps({"total": study(Path(words[0], "store"), words[2])["total"].value}))
    else:
        main(Path(words[0]), int(words[1]), words[2])
