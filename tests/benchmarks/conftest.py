"""Benchmarks: this machine beside its peers, the same work in one run.

They are not part of the normal test run, and none fails on a clock: what they assert is that all
engines give the same results. How to run them::

    pip install -e '.[bench]'
    python -m pytest tests/benchmarks

A peer that is not installed is skipped. At the end stands one table per case, with the fastest
round of each row, because other programs only ever add time, and the ratio to ours: 2.0 is twice
what nodegraph takes. ``--benchmark-json=FILE`` keeps every round;
``--benchmark-timer=time.process_time`` counts processor time instead, for a busy machine.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.benchmarks.tables import Tables

HERE = Path(__file__).parent
TABLES = Tables()

for switch in ("HAMILTON_TELEMETRY_ENABLED", "HAYSTACK_TELEMETRY_ENABLED"):
    os.environ[switch] = "false"
for switch in ("DO_NOT_TRACK", "KEDRO_DISABLE_TELEMETRY"):
    os.environ[switch] = "1"

Clock = Callable[..., Any]


def pytest_configure(config: pytest.Config) -> None:
    if not config.pluginmanager.hasplugin("benchmark"):
        raise pytest.UsageError("benchmarks need more packages: pip install -e '.[bench]'")
    config.option.benchmark_quiet = True  # its own table would repeat ours, a row per column
    config.option.dist = "no"  # else nothing is timed where xdist is installed


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if HERE in item.path.parents:  # a peer's deprecations are none of our mistakes
            item.add_marker(pytest.mark.filterwarnings("ignore"))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    for line in TABLES.lines():
        terminalreporter.write_line(line)


@pytest.fixture
def tables() -> Tables:
    """Where figures that no clock measures are written."""
    return TABLES


@pytest.fixture
def clock(benchmark: Any) -> Clock:
    """Time a call, and write its fastest round into a table, per unit of work."""

    def measure(
        case: str,
        name: str,
        column: str,
        call: Callable[..., Any],
        *,
        per: int = 1,
        scale: float = 1e6,
        rounds: int = 5,
    ) -> object:
        benchmark.group = f"{case}: {column}"
        result = benchmark.pedantic(call, rounds=rounds, warmup_rounds=1)
        if benchmark.stats is not None:  # None under --benchmark-disable
            TABLES.put(case, name, column, benchmark.stats.stats.min / per * scale)
        return result

    return measure


@pytest.fixture
def deep() -> Iterator[None]:
    """Room for peers that call themselves once per node."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(50_000)
    yield
    sys.setrecursionlimit(limit)
