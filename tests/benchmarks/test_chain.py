"""A chain of trivial nodes: what each engine itself costs, per node."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.benchmarks.conftest import Clock
from tests.benchmarks.engines.apache_hamilton import hamilton
from tests.benchmarks.engines.bare import bare
from tests.benchmarks.engines.dask_delayed import dask
from tests.benchmarks.engines.ewoks import ewokscore
from tests.benchmarks.engines.haystack_pipeline import haystack
from tests.benchmarks.engines.joblib_memory import joblib
from tests.benchmarks.engines.kedro_sequential import kedro
from tests.benchmarks.engines.ours import nodegraph
from tests.benchmarks.engines.pipefunc_pipeline import pipefunc
from tests.benchmarks.work import NUMBERS, Engine

CASE = "chain of 1,000 trivial nodes"
ENGINES: dict[str, tuple[Engine, int, int]] = {  # with steps and rounds
    "nodegraph": (nodegraph("serial"), 1000, 10),
    "nodegraph, threads": (nodegraph("threads"), 1000, 10),
    "bare networkx": (bare, 1000, 20),
    "Hamilton": (hamilton, 1000, 10),
    "dask, synchronous": (dask, 1000, 5),
    "Kedro": (kedro, 1000, 3),
    "Haystack": (haystack, 1000, 3),
    # these two build in more than linear time: 1,000 nodes would take minutes, or forever
    "pipefunc": (pipefunc, 100, 3),
    "ewokscore": (ewokscore, 12, 3),
}


@pytest.mark.parametrize("name", ENGINES)
def test_build(name: str, clock: Clock, deep: None) -> None:
    engine, count, rounds = ENGINES[name]
    run = clock(
        CASE, _named(name), "build us/node", engine(NUMBERS, count), per=count, rounds=rounds
    )
    assert run() == count


@pytest.mark.parametrize("name", ENGINES)
def test_run(name: str, clock: Clock, deep: None) -> None:
    engine, count, rounds = ENGINES[name]
    run = engine(NUMBERS, count)()
    assert clock(CASE, _named(name), "run us/node", run, per=count, rounds=rounds) == count


def test_build_of_joblib(clock: Clock, tmp_path: Path) -> None:
    build = joblib(tmp_path)(NUMBERS, 1000)
    run = clock(CASE, "joblib.Memory, hit", "build us/node", build, per=1000)
    assert run() == 1000


def test_run_of_joblib(clock: Clock, tmp_path: Path) -> None:
    run = joblib(tmp_path)(NUMBERS, 1000)()
    run()
    assert clock(CASE, "joblib.Memory, hit", "run us/node", run, per=1000, rounds=3) == 1000


def _named(name: str) -> str:
    count = ENGINES[name][1]
    return name if count == 1000 else f"{name} ({count} nodes)"
