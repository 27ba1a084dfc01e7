"""Whatever runs a step, numerical libraries use one thread in it; afterwards, what they used."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from nodegraph.execute.executor import HowToRun
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

GRAPH = """
nodegraph: 1
axes: {trial: {count: 4}}
nodes:
  a: {use: toy.threads, with: {seed: $trial}}
  most: {use: toy.most, in: a}
"""
NODES = """
import os
import numpy
from threadpoolctl import threadpool_info
from nodegraph import Across, node

@node("toy.threads")
def threads(*, seed: int) -> int:
    numpy.ones((2, 2)) @ numpy.ones((2, 2))
    loaded = [one["num_threads"] for one in threadpool_info()]
    return max([int(os.environ["OPENBLAS_NUM_THREADS"]), *loaded])

@node("toy.most")
def most(many: Across[int]) -> int:
    return max(many.values())
"""


@pytest.fixture(autouse=True)
def _two_threads(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "2")
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    with threadpool_limits(limits=2):
        yield


def threads_now(*apis: str) -> set[int]:
    """Return how many threads libraries use in this thread."""
    np.linalg.norm(np.ones((3, 3)))
    infos = threadpool_info()
    return {info["num_threads"] for info in infos if not apis or info["user_api"] in apis}


@pytest.fixture(scope="module", autouse=True)
def _openmp() -> None:
    """A library that keeps the number of its threads for each thread that calls it."""
    import sklearn.cluster  # noqa: F401

    assert "openmp" in {info["user_api"] for info in threadpool_info()}


@pytest.mark.parametrize("executor", ["serial", "threads", "processes"])
def test_steps_see_one_thread(executor: str, tmp_path: Path) -> None:
    file = tmp_path / "threads.py"
    file.write_text(NODES)
    graph = build(read_graph_text(GRAPH, "toy.yaml", Path()), Registry.installed([file]))
    run = execute(plan(graph), how=HowToRun(executor, 2), keep=["most"])
    assert run["most"].value == 1
    assert threads_now() == {2}


def test_a_value_that_is_computed_again_is_the_same(tmp_path: Path) -> None:
    file = tmp_path / "threads.py"
    file.write_text(NODES)
    graph = build(read_graph_text(GRAPH, "toy.yaml", Path()), Registry.installed([file]))
    assert execute(plan(graph))["a"].at(trial=2) == 1


def test_the_limit_holds_until_the_last_thread_leaves_and_leaves_no_trace() -> None:
    entered, left = threading.Event(), threading.Event()
    inside: list[set[int]] = []

    def other() -> None:
        with one_thread_each():
            entered.set()
            left.wait()
            inside.append(threads_now())

    thread = threading.Thread(target=other)
    with one_thread_each():
        thread.start()
        entered.wait()
    assert threads_now("blas") == {1}
    assert os.environ["OMP_NUM_THREADS"] == "1"
    left.set()
    thread.join()
    assert inside == [{1}]
    assert threads_now() == {2}
    assert os.environ["OPENBLAS_NUM_THREADS"] == "2"
    assert "OMP_NUM_THREADS" not in os.environ
    with one_thread_each():
        pass
    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert inside == [{1}, {1}]
