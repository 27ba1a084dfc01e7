"""Steps of a run that give the same result again, and those that do not."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from nodegraph import Refusal, node
from nodegraph.api import reported
from nodegraph.audit.audit import AGAIN, PROCESS, STORED, THREADS, Audited, audit, cases
from nodegraph.audit.drift import AuditGrade
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.execute.resume import open_store
from nodegraph.execute.run import execute
from nodegraph.graph import Choices, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry

RunOf = Callable[..., Run]
CALLS: Counter[str] = Counter()


def count(name: str) -> int:
    """Return how often a node has been called in this process."""
    CALLS[name] += 1
    return CALLS[name]


@node("odd.make")
def make(*, size: int = 50) -> np.ndarray:
    return np.arange(1.0, size)


@node("odd.good")
def good(x: np.ndarray) -> np.ndarray:
    return x * 2


@node("odd.counts")
def counts(x: np.ndarray) -> np.ndarray:
    result = x.copy()
    result[3] += count("counts")
    return result


@node("odd.drifts")
def drifts(x: np.ndarray) -> np.ndarray:
    return x * (1 + 1e-15 * count("drifts"))


@node("odd.process")
def process(x: np.ndarray) -> int:
    return os.getpid()


@node("odd.folder")
def folder() -> str:
    return str(Path.cwd())


@node("odd.threads")
def threads(x: np.ndarray) -> int:
    return int(max(pool["num_threads"] for pool in threadpool_info()))


@node("odd.refuses_later")
def refuses_later(x: np.ndarray) -> float:
    if count("refuses_later") > 1:
        raise Refusal("had enough")
    return 1.0


@node("odd.items")
def items() -> list:  # type: ignore[type-arg]
    return [1.0, 2.0]


@node("odd.appends")
def appends(x: list) -> float:  # type: ignore[type-arg]
    x.append(3.0)
    return 1.0


@node("odd.limit")
def limit(*, below: float = 0.0) -> float:
    if below > 1:
        raise Refusal("too high")
    return below


ODD = (
    make, good, counts, drifts, process, folder, threads, refuses_later, items, appends, limit,
)  # fmt: skip


GRAPH = """
nodes:
  make: {use: odd.make}
  good: {use: odd.good, in: make}
  drifts: {use: odd.drifts, in: make}
  counts: {use: odd.counts, in: make}
  process: {use: odd.process, in: make}
  folder: {use: odd.folder}
  threads: {use: odd.threads, in: make}
  refuses_later: {use: odd.refuses_later, in: make}
  items: {use: odd.items}
  appends: {use: odd.appends, in: items}
  refused: {use: odd.limit, with: {below: 3}}
"""
VARYING = """
nodes:
  make: {use: odd.make}
  tested: {use: odd.counts, in: make}
  after: {use: odd.good, in: tested}
"""


@pytest.fixture(scope="module")
def audited(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Audited]:
    """What the audit of a graph of odd nodes reports, by node."""
    CALLS.clear()
    registry = Registry.of(ODD, plugin="odd")
    folder = tmp_path_factory.mktemp("audited")
    spec = read_graph_text(f"nodegraph: 1{GRAPH}", "odd.yaml", folder)
    store = open_store(registry, folder / "store", pytest.fail)
    graph = build(spec, registry, Choices(folder=folder))
    run = execute(plan(graph), how=HowToRun("serial"), store=store, keep=reported(graph))
    indices = [index for steps in cases(run).values() for index in steps]
    return {result.step.node: result for result in audit(run, indices)}


def test_a_deterministic_node_is_identical_under_every_condition(
    audited: dict[str, Audited],
) -> None:
    result = audited["good"]
    assert result == Audited(result.step, AuditGrade.IDENTICAL)


@pytest.mark.parametrize(
    ("node", "grade", "conditions", "varies"),
    [
        ("drifts", "close", {AGAIN, THREADS, STORED}, False),
        ("counts", "differs", {AGAIN, THREADS, STORED}, True),
        ("process", "differs", {PROCESS}, True),
        ("folder", "differs", {PROCESS}, True),
        ("threads", "differs", {THREADS}, False),
        ("refuses_later", "differs", {STORED}, True),
    ],
)
def test_a_result_that_varies_is_reported_with_the_conditions(
    audited: dict[str, Audited], node: str, grade: str, conditions: set[str], varies: bool
) -> None:
    result = audited[node]
    assert result.grade == grade
    # another process counts its own calls, and may have come to the same number
    ignored = {PROCESS} if node not in ("process", "folder") else set()
    assert set(result.conditions) - ignored == conditions
    assert result.varies == varies


def test_a_difference_is_located(audited: dict[str, Audited]) -> None:
    [text] = audited["counts"].details
    assert text.startswith("value[3]: ")


def test_a_node_that_refuses_when_it_is_repeated_is_reported(audited: dict[str, Audited]) -> None:
    [text] = audited["refuses_later"].details
    assert "done" in text
    assert "refused (had enough)" in text


def test_a_node_that_modifies_an_input_is_reported_with_its_name(
    audited: dict[str, Audited],
) -> None:
    result = audited["appends"]
    [text] = result.details
    assert result.grade is AuditGrade.MUTATES
    assert text.endswith(" input x")
    assert not result.varies


def test_a_step_without_a_result_has_the_grade_of_its_state(audited: dict[str, Audited]) -> None:
    assert (audited["refused"].grade, audited["refused"].details) == ("refused", ("too high",))


def test_a_step_is_not_blamed_for_inputs_that_vary(run_of: RunOf, tmp_path: Path) -> None:
    for _ in range(2):
        run = run_of(VARYING, more=ODD, store=tmp_path / "store")
        grades = {
            result.step.node: result.grade for result in audit(run, range(len(run.plan.steps)))
        }
        assert grades == {"make": "identical", "tested": "differs", "after": "identical"}


def test_later_runs_neither_load_nor_store_results_that_vary(run_of: RunOf, tmp_path: Path) -> None:
    store = tmp_path / "store"
    first = run_of(VARYING, more=ODD, store=store)
    assert first.cache is not None
    assert not first.cache.not_stored
    assert run_of(VARYING, more=ODD, store=store).counts()["stored"] == 3
    list(audit(first, [1]))

    later = run_of(VARYING, more=ODD, store=store)
    assert later.cache is not None
    reasons = list(later.cache.not_stored)
    assert len(reasons) == 2
    assert reasons[0].startswith("odd.counts: ")
    assert AGAIN in reasons[0]
    warnings = {step.node: outcome.warnings for step, outcome in later.settled()}
    assert warnings["after"] == warnings["make"] == ()
    assert "not stored" in warnings["tested"][0]
    assert later.outcomes[0].stored
    assert not later.outcomes[1].stored


def test_the_first_combination_with_a_result_represents_a_method(run_of: RunOf) -> None:
    text = """
    axes: {below: [5, 0.5, 0.25]}
    nodes:
      limit: {use: odd.limit, with: {below: $below}}
    """
    run = run_of(text, more=ODD)
    assert cases(run) == {("limit", ""): (run.plan.cells["limit"][0.5,],)}
    assert cases(run, every=True) == {("limit", ""): tuple(run.plan.cells["limit"].values())}
