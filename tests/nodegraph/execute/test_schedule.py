from __future__ import annotations

from collections.abc import Callable

from nodegraph.execute.call import Outcome, perform
from nodegraph.execute.schedule import Schedule
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


class Heard:
    """Keeps what a schedule tells."""

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
    observer = Heard()
    schedule = Schedule(plan(graph_of(TEXT)), observer=observer)
    call = schedule.next()
    assert call is not None
    schedule.finish(call.step, Outcome(State.FAILED, reason="broken"))
    step, found = observer.ended[0]
    assert (step.node, found.state, found.root) == ("a", "failed", "failed")
    assert {step.node for step, found in observer.ended if found.state == "skipped"} == {"b", "c"}
    rest = schedule.next()
    assert rest is not None
    assert rest.node.name == "text.write"


def test_only_what_is_wanted_and_what_it_needs_is_computed(graph_of: Callable[..., Graph]) -> None:
    made = plan(graph_of(TEXT))
    wanted = made.cells["c"][()]
    schedule = Schedule(made, keep=[wanted], wanted=[wanted])
    done = []
    while (call := schedule.next()) is not None:
        schedule.finish(call.step, perform(call))
        done.append(call.node.name)
    assert done == ["read.number", "fill.scale"]
    assert schedule.values == {wanted: (2.0,)}
