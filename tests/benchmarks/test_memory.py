"""Peak memory of a chain of arrays: how many of them an engine holds at a time."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from tests.benchmarks.engines.apache_hamilton import hamilton
from tests.benchmarks.engines.bare import bare
from tests.benchmarks.engines.dask_delayed import dask
from tests.benchmarks.engines.haystack_pipeline import haystack
from tests.benchmarks.engines.kedro_sequential import kedro
from tests.benchmarks.engines.ours import nodegraph
from tests.benchmarks.engines.pipefunc_pipeline import pipefunc
from tests.benchmarks.tables import Tables
from tests.benchmarks.work import ARRAY_BYTES, ARRAYS, Engine

COUNT = 49
ENGINES: dict[str, Engine] = {
    "nodegraph": nodegraph("serial"),
    "nodegraph, threads": nodegraph("threads"),
    "bare networkx": bare,
    "Hamilton": hamilton,
    "dask, synchronous": dask,
    "Kedro": kedro,
    "Haystack": haystack,
    "pipefunc": pipefunc,
}


@pytest.mark.parametrize("name", ENGINES)
def test_peak(name: str, tables: Tables) -> None:
    run = ENGINES[name](ARRAYS, COUNT)()
    tracemalloc.start()
    try:
        value = run()
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    case = f"peak memory of a chain of 50 nodes, in arrays of {ARRAY_BYTES // 1_000_000} MB"
    tables.put(case, name, "arrays", peak / ARRAY_BYTES)
    assert np.all(value == COUNT)
