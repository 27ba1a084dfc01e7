"""Calls come in the order of the plan, and a value is released when its last reader is done."""

from __future__ import annotations

import gc
import threading
import weakref
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from nodegraph import Across, Value, node
from nodegraph.execute.call import perform
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.results import Run
from nodegraph.execute.run import execute
from nodegraph.execute.schedule import Schedule
from nodegraph.gc_pause import gc_paused
from nodegraph.graph import Graph
from nodegraph.plan import Step, plan
from nodegraph.state import State

TEXT = """
nodes:
  a: {use: read.number}
  b: {use: fill.hold, in: a}
  c: {use: fill.scale, in: a}
  d: {use: text.write}
"""


class Record:
    """Keeps how steps ended."""

    def __init__(self) -> None:
        self.ended: list[tuple[Step, Outcome]] = []

    def started(self, step: Step) -> None:
        pass

    def settled(self, step: Step, outcome: Outcome) -> None:
        self.ended.append((step, outcome))


def test_a_call_waits_for_what_it_needs(graph_of: Callable[..., Graph]) -> None:
    schedule = Schedule(plan(graph_of(TEXT)))
    first, other = schedule.next(), schedule.next()
    assert first is not None
    assert other is not None
    assert {first.node.name, other.node.name} == {"read.number", "text.write"}
    assert schedule.next() is None
    schedule.finish(first.step, perform(first))
    second = schedule.next()
    assert second is not None
    assert second.inputs == {"recording": 1.0}


def test_a_value_goes_with_its_last_reader(graph_of: Callable[..., Graph]) -> None:
    schedule = Schedule(plan(graph_of(TEXT)))
    held = []
    while (call := schedule.next()) is not None:
        schedule.finish(call.step, perform(call))
        held.append(sorted(schedule.values))
    assert held == [[0], [0], [], []]


def test_what_a_failure_makes_impossible_is_settled_with_it(graph_of: Callable[..., Graph]) -> None:
    observer = Record()
    schedule = Schedule(plan(graph_of(TEXT)), observer=observer)
    call = schedule.next()
    assert call is not None
    schedule.finish(call.step, Outcome(State.FAILED, reason="broken"))
    step, outcome = observer.ended[0]
    assert (step.node, outcome.state, outcome.root) == ("a", "failed", "failed")
    skipped = {step.node for step, outcome in observer.ended if outcome.state == "skipped"}
    assert skipped == {"b", "c"}
    rest = schedule.next()
    assert rest is not None
    assert rest.node.name == "text.write"


def test_only_what_is_wanted_and_what_it_needs_is_computed(graph_of: Callable[..., Graph]) -> None:
    steps = plan(graph_of(TEXT))
    wanted = steps.cells["c"][()]
    schedule = Schedule(steps, keep=[wanted], wanted=[wanted])
    called = []
    while (call := schedule.next()) is not None:
        schedule.finish(call.step, perform(call))
        called.append(call.node.name)
    assert called == ["read.number", "fill.scale"]
    assert schedule.values == {wanted: (2.0,)}


WAYS = [HowToRun("serial"), HowToRun("threads", 1), HowToRun("threads", 3)]
ALIVE: weakref.WeakSet[Big] = weakref.WeakSet()
PEAK: list[int] = []


@dataclass(frozen=True, eq=False)
class Big(Value):
    """A value whose instances are counted while they live."""

    number: float = 0.0


def counted(number: float) -> Big:
    big = Big(number)
    ALIVE.add(big)
    PEAK.append(len(ALIVE))
    return big


@node("big.make")
def make(*, number: float = 0.0) -> Big:
    return counted(number)


@node("big.next")
def following(big: Big, *, add: float = 1.0) -> Big:
    ALIVE.add(big)  # which is a copy
    return counted(big.number + add)


@node("big.size")
def size(big: Big) -> float:
    return big.number


@node("big.sum")
def total(sizes: Across[float]) -> float:
    return sum(sizes.values())


BIG = (make, following, size, total)


@pytest.fixture
def peak() -> list[int]:
    gc.collect()
    ALIVE.clear()
    PEAK.clear()
    return PEAK


@pytest.mark.parametrize("how", WAYS[:2])
def test_a_chain_holds_two_values_at_most(
    run_of: Callable[..., Run], peak: list[int], how: HowToRun
) -> None:
    lines = [f"  n{i}: {{use: big.next, in: n{i - 1}}}" for i in range(1, 30)]
    text = (
        "nodes:\n  n0: {use: big.make}\n" + "\n".join(lines) + "\n  end: {use: big.size, in: n29}\n"
    )
    run = run_of(text, more=BIG, how=how)
    assert run["end"].value == 29
    assert max(peak) == 2
    assert len(ALIVE) == 0


@pytest.mark.parametrize("how", WAYS)
def test_a_wide_fan_does_not_keep_all(
    run_of: Callable[..., Run], peak: list[int], how: HowToRun
) -> None:
    text = """
        axes: {k: {count: 40}}
        nodes:
          a: {use: big.make}
          b: {use: big.next, in: a, with: {add: $k}}
          c: {use: big.next, in: b}
          d: {use: big.size, in: c}
          e: {use: big.sum, in: d}
        """
    run = run_of(text, more=BIG, how=how)
    assert run["e"].value == sum(range(1, 41))
    assert len(peak) == 81
    assert max(peak) <= (4 if how.executor == "serial" else 12)
    assert len(ALIVE) == 0


def test_what_is_reported_stays(run_of: Callable[..., Run], peak: list[int]) -> None:
    text = "nodes: {a: {use: big.make}, b: {use: big.next, in: a}, c: {use: big.next, in: b}}"
    run = run_of(f"{text}\nreport: [b]", more=BIG)
    assert [big.number for big in ALIVE] == [1]
    assert run["b"].value is next(iter(ALIVE))
    assert run["c"].value.number == 2


def test_values_of_a_run_that_is_dropped_are_freed_at_once(
    graph_of: Callable[..., Graph], peak: list[int]
) -> None:
    graph = graph_of("nodes:\n  a: {use: big.make}\n", more=BIG)
    with gc_paused():
        run = execute(plan(graph), keep=["a"], listeners=[lambda event: None])
        assert (run["a"].value.number, len(ALIVE)) == (0.0, 1)
        del run
        assert len(ALIVE) == 0


def test_an_interrupt_while_a_thread_is_started_ends_the_run(
    graph_of: Callable[..., Graph], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: threading.Thread) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(threading.Thread, "start", interrupted)
    with pytest.raises(KeyboardInterrupt):
        execute(plan(graph_of(TEXT)), how=HowToRun("threads", jobs=2))
