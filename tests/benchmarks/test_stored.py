"""A second run of arrays that are stored: what is read again although nobody asks for it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from tests.benchmarks.conftest import Clock
from tests.benchmarks.engines.apache_hamilton import hamilton_cached
from tests.benchmarks.engines.joblib_memory import joblib
from tests.benchmarks.engines.ours import nodegraph_stored
from tests.benchmarks.tables import Tables
from tests.benchmarks.work import LARGE_ARRAYS, Engine

COUNT = 19
CASE = "20 nodes of 50 MB each, results on disk"
ENGINES: dict[str, Callable[[Path], Engine]] = {
    "nodegraph": partial(nodegraph_stored, requested=False),
    "nodegraph, last value read": partial(nodegraph_stored, requested=True),
    "joblib.Memory": joblib,
    "Hamilton, cached": hamilton_cached,
}


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that goes at once: pytest would keep gigabytes of three runs."""
    with TemporaryDirectory() as path:
        yield Path(path)


@pytest.mark.parametrize("name", ENGINES)
def test_second_run(name: str, clock: Clock, tables: Tables, folder: Path) -> None:
    run = ENGINES[name](folder)(LARGE_ARRAYS, COUNT)()
    began = time.perf_counter()
    first = run()
    tables.put(CASE, name, "first run, ms", (time.perf_counter() - began) * 1e3)
    second = clock(CASE, name, "second run, ms", run, scale=1e3, rounds=3)
    if name != "nodegraph":
        assert np.all(first == COUNT)
        assert np.all(second == COUNT)
