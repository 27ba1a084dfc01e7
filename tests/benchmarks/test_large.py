"""Ten thousand nodes, as a chain and as a fan: each stage, beside a hundred nodes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from nodegraph import node
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.run import execute
from nodegraph.graph import build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry
from tests.benchmarks.conftest import Clock
from tests.benchmarks.engines.ours import HERE, chain_text
from tests.benchmarks.work import plus_one, zero


@node("bench.times")
def times(value: float, *, factor: int) -> float:
    return (value + 1.0) * factor


def fan_text(count: int) -> str:
    """Return the text of so many nodes that read the same one; each has a setting of its own."""
    lines = [
        f"  n{at + 1}: {{use: bench.times, in: n0, with: {{factor: {at + 1}}}}}"
        for at in range(count)
    ]
    return "\n".join(["nodegraph: 1", "nodes:", "  n0: {use: bench.first}", *lines, ""])


REGISTRY = Registry.of([node("bench.first")(zero), node("bench.step")(plus_one), times])
TEXTS: dict[str, Callable[[int], str]] = {"chain": chain_text, "fan": fan_text}
STAGES = ("read", "check", "plan", "run")
COUNTS = (100, 10_000)
ROUNDS = {100: 30, 10_000: 3}


@pytest.mark.parametrize("stage", STAGES)
@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("shape", TEXTS)
def test_stage(shape: str, count: int, stage: str, clock: Clock) -> None:
    text, last = TEXTS[shape](count), f"n{count}"
    spec = read_graph_text(text, "large.yaml", HERE)
    graph = build(spec, REGISTRY)
    planned = plan(graph)
    calls: dict[str, Callable[[], Any]] = {
        "read": lambda: read_graph_text(text, "large.yaml", HERE),
        "check": lambda: build(spec, REGISTRY),
        "plan": lambda: plan(graph),
        "run": lambda: execute(planned, how=HowToRun("serial"), keep=[last]),
    }
    case = "cost per node of a large graph, us"
    clock(case, f"{shape} of {count:,}", stage, calls[stage], per=count, rounds=ROUNDS[count])
    run = calls["run"]()
    assert run[last].value == count
    assert run.counts()["done"] == count + 1
