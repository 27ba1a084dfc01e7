"""Comparing many methods: the whole node, and its p beside scipy's."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest
from scipy.stats import studentized_range

from nodegraph import Across
from nodegraph_compare.studentised_range import survival
from nodegraph_compare.table.node import table
from tests.benchmarks.conftest import Clock

GROUPS, ACTORS, GAPS = 5, 8, 12
Q = np.linspace(0.5, 8.0, 40)


@pytest.mark.parametrize("methods", [20, 200])
def test_table(methods: int, clock: Clock) -> None:
    random = np.random.default_rng(0)
    tables = {
        (actor, length, method): pd.DataFrame(
            {"gap": range(GAPS), "rmse": np.exp(random.normal(length, 0.3, GAPS))}
        )
        for actor in range(ACTORS)
        for length in range(GROUPS)
        for method in range(methods)
    }
    axes = ("actor", "length", "method")
    entries = tuple((dict(zip(axes, at, strict=True)), each) for at, each in tables.items())
    scores = Across(axes, entries, sources=("actor",))

    def compare() -> int:
        return len(table(scores, compare="method", within=("length",), blocks=("gap",)).table)

    case = f"compare.table, {GROUPS} groups, {ACTORS * GAPS} blocks"
    rows = clock(case, f"{methods} methods", "s", compare, rounds=1, scale=1.0)
    assert rows == (GROUPS + 1) * methods


@pytest.mark.parametrize("name", ["nodegraph", "scipy"])
def test_p(name: str, clock: Clock) -> None:
    functions: dict[str, Callable[..., object]] = {
        "nodegraph": survival,
        "scipy": studentized_range.sf,
    }
    p = clock(
        "p of the studentised range, 200 means",
        name,
        "us each",
        lambda: functions[name](Q, 200, 1393),
        per=len(Q),
        rounds=1,
    )
    np.testing.assert_allclose(p, survival(Q, 200, 1393), rtol=0, atol=1e-9)
