"""An audit tells nodes of one answer from those of several, and the store learns of these."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from nodegraph import Refusal, node
from nodegraph.audit.audit import AGAIN, PROCESS, STORED, THREADS, Audited, audit, cases
from nodegraph.audit.repeat import Given, drift, numeric_threads
from nodegraph.execute import Run
from nodegraph.plugin.hook_types import Storage
from nodegraph.store import Packer

RunOf = Callable[..., Run]
_calls = itertools.count(1)


@node("odd.make")
def make(*, size: int = 50) -> np.ndarray:
    return np.arange(1.0, size)


@node("odd.good")
def good(x: np.ndarray) -> np.ndarray:
    return x * 2


@node("odd.counts")
def counts(x: np.ndarray) -> np.ndarray:
    made = x.copy()
    made[3] += next(_calls)
    return made


@node("odd.drifts")
def drifts(x: np.ndarray) -> np.ndarray:
    return x * (1 + 1e-15 * next(_calls))


@node("odd.process")
def process(x: np.ndarray) -> int:
    return os.getpid()


@node("odd.threads")
def threads(x: np.ndarray) -> int:
    return int(max(one["num_threads"] for one in threadpool_info()))


@node("odd.refuses_later")
def refuses_later(x: np.ndarray) -> float:
    if next(_calls) > 1:
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
    make, good, counts, drifts, process, threads, refuses_later, items, appends, limit,
)  # fmt: skip


def text_of(method: str) -> str:
    return f"""
    nodes:
      make: {{use: odd.make}}
      made: {{use: {method}, in: make}}
    """


@pytest.fixture
def audited(run_of: RunOf, tmp_path: Path) -> Callable[[str], dict[str, Audited]]:
    def audit_it(text: str, **more: Any) -> dict[str, Audited]:
        global _calls
        _calls = itertools.count(1)
        run = run_of(text, more=ODD, store=tmp_path / "store", **more)
        steps = [index for chosen in cases(run).values() for index in chosen]
        return {one.step.node: one for one in audit(run, steps)}

    return audit_it


def test_a_node_of_one_answer_is_identical_everywhere(
    audited: Callable[[str], dict[str, Audited]],
) -> None:
    found = audited(text_of("odd.good"))["made"]
    assert (found.grade, found.under, found.said, found.untried) == ("identical", (), (), ())


@pytest.mark.parametrize(
    ("method", "grade", "under", "doubted"),
    [
        ("odd.drifts", "close", {AGAIN, THREADS, STORED}, False),
        ("odd.counts", "differs", {AGAIN, THREADS, STORED}, True),
        ("odd.process", "differs", {PROCESS}, True),
        ("odd.threads", "differs", {THREADS}, False),
        ("odd.refuses_later", "differs", {STORED}, True),
    ],
)
def test_a_node_of_several_answers_is_told_with_the_conditions(
    audited: Callable[[str], dict[str, Audited]],
    method: str,
    grade: str,
    under: set[str],
    doubted: bool,
) -> None:
    found = audited(text_of(method))["made"]
    assert found.grade == grade
    # another process counts its own calls, and may have come to the same number
    assert set(found.under) - {PROCESS} == under - {PROCESS}
    assert found.is_one_of_several == doubted


def test_what_differs_is_named(audited: Callable[[str], dict[str, Audited]]) -> None:
    [said] = audited(text_of("odd.counts"))["made"].said
    assert said.startswith("value[3]: ")


def test_a_node_that_refuses_when_it_is_repeated_is_told(
    audited: Callable[[str], dict[str, Audited]],
) -> None:
    said = audited(text_of("odd.refuses_later"))["made"].said
    # another process counts its own calls
    assert said in (
        ("refused (had enough) once, done then",),
        ("it was done, now it is refused (had enough)",),
    )


def test_a_node_that_changes_what_it_was_lent_is_told(
    audited: Callable[[str], dict[str, Audited]],
) -> None:
    found = audited("nodes: {items: {use: odd.items}, x: {use: odd.appends, in: items}}")["x"]
    assert (found.grade, found.said) == ("mutates", ("changes its input x",))
    assert not found.is_one_of_several


def test_what_is_fed_by_a_node_of_several_answers_is_not_accused(
    run_of: RunOf, tmp_path: Path
) -> None:
    text = f"{text_of('odd.counts')}  after: {{use: odd.good, in: made}}\n"
    for _ in range(2):
        run = run_of(text, more=ODD, store=tmp_path / "store")
        grades = {one.step.node: one.grade for one in audit(run, range(len(run.plan.steps)))}
        assert grades == {"make": "identical", "made": "differs", "after": "identical"}


def test_later_runs_neither_use_nor_keep_results_of_a_node_of_several_answers(
    run_of: RunOf, tmp_path: Path
) -> None:
    text = f"{text_of('odd.counts')}  after: {{use: odd.good, in: made}}\n"
    store = tmp_path / "store"
    first = run_of(text, more=ODD, store=store)
    assert first.cache is not None
    assert not first.cache.not_stored
    assert run_of(text, more=ODD, store=store).counts()["stored"] == 3
    list(audit(first, [1]))

    later = run_of(text, more=ODD, store=store)
    assert later.cache is not None
    [why, follows] = later.cache.not_stored
    assert (
        why
        == "odd.counts: an audit found that it gives another answer in a second call, "
        + (why.split(", ", 1)[1])
    )
    assert follows == "they are made of results that are not stored"
    said = {step.node: outcome.warnings for step, outcome in later.settled()}
    assert said["after"] == said["make"] == ()
    assert said["made"][0].endswith("this result is one of several, and is not stored")
    assert later.outcomes[0].stored
    assert not later.outcomes[1].stored


def test_one_combination_of_each_method_is_taken_the_first_with_a_result(run_of: RunOf) -> None:
    text = """
    axes: {below: [5, 0.5, 0.25]}
    nodes:
      limit: {use: odd.limit, with: {below: $below}}
    """
    run = run_of(text, more=ODD)
    assert cases(run) == {("limit", ""): (run.plan.cells["limit"][0.5,],)}
    assert cases(run, every=True) == {("limit", ""): tuple(run.plan.cells["limit"].values())}


def test_a_step_without_result_is_told_as_it_ended(
    audited: Callable[..., dict[str, Audited]],
) -> None:
    text = "nodes: {a: {use: odd.limit, with: {below: 3}}, b: {use: odd.limit}}"
    found = audited(text)
    assert (found["a"].grade, found["a"].said) == ("refused", ("too high",))
    assert found["b"].grade == "identical"


def test_numbers_are_close_relative_to_what_they_are_made_of() -> None:
    def apart(one: Any, other: Any, floor: float = 0.0) -> str:
        first, second = (Given.of((value,), Packer()) for value in (one, other))
        return drift(first, second, ["x"], (), floor).grade

    x = np.linspace(1, 2, 30)
    assert apart(x, x.copy()) == "identical"
    assert apart(x, np.asfortranarray(x + 0.0)) == "identical"
    assert apart(x, x * (1 + 1e-14)) == "close"
    assert apart(x, x * (1 + 1e-6)) == "differs"
    assert apart(x * 1e-18, x * 2e-18) == "differs"
    assert apart(x * 1e-18, x * 2e-18, floor=1e-3) == "close"
    assert apart(np.array([0.0, 1.0]), np.array([-0.0, 1.0])) == "close"
    assert apart(np.array([np.nan, 1.0]), np.array([1.0, 1.0])) == "differs"
    assert apart(3, 4) == "differs"
    assert apart(x.reshape(5, 6), x.reshape(6, 5)) == "differs"


def test_numeric_threads_hold_for_a_while() -> None:
    def now() -> set[int]:
        return {one["num_threads"] for one in threadpool_info()}

    before = now()
    with numeric_threads(1):
        assert now() == {1}
        with numeric_threads(2):
            assert now() == {2}
        assert now() == {1}
    assert now() == before


def test_a_drawing_is_drawn_once_to_be_compared_often() -> None:
    drawn: list[int] = []

    class Drawing:
        """Is another one each time that it is looked at, as a figure that lays itself out."""

        def __init__(self) -> None:
            self.looks = 0

    def take_apart(value: Drawing) -> int:
        value.looks += 1
        drawn.append(value.looks)
        return value.looks

    given = [Given.of((Drawing(),), Packer([Storage(Drawing, take_apart, int, False)]))] * 2
    given.append(Given.of((Drawing(),), Packer([Storage(Drawing, take_apart, int, False)])))
    assert [drift(given[0], one, ["x"], ()).grade for one in given] == ["identical"] * 3
    assert drawn == [1, 1]
