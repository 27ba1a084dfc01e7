"""Drives an executor through a plan, tells what happens, and keeps what was asked for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from nodegraph.execute.call import Outcome, warnings_heard
from nodegraph.execute.events import Clock, Event, Listener
from nodegraph.execute.executors import HowToRun, executor_of
from nodegraph.execute.results import Run
from nodegraph.execute.schedule import Schedule
from nodegraph.plan import Plan, Step


def execute(
    plan: Plan,
    *,
    how: HowToRun | None = None,
    keep: Iterable[str] = (),
    listeners: Iterable[Listener] = (),
) -> Run:
    """Run every step of a plan; one that fails does not stop the others.

    Parameters
    ----------
    plan
    how
        Executor and number of calls at a time.
    keep
        Nodes whose values stay in memory. Those of others are computed again when asked for.
    listeners
        Each is called with every `Event`, in this thread.
    """
    how = how or HowToRun()
    executor = executor_of(how, plan.graph.registry.executors)
    kept = [index for name in keep for index in plan.cells.get(name, {}).values()]
    teller = _Teller(tuple(listeners), Clock())
    schedule = Schedule(plan, keep=kept, on_start=lambda step: teller.tell("started", step))
    teller.tell("planned", steps=len(plan.steps), nodes=len(plan.graph.nodes))
    with warnings_heard():
        for index, outcome in executor(schedule, how):
            for step, found in schedule.finish(index, outcome):
                teller.settled(step, found)
    run = Run(plan, schedule.outcomes, schedule.values, teller.clock.seconds())
    teller.tell("finished", None, **run.counts())
    return run


class _Teller:
    def __init__(self, listeners: tuple[Listener, ...], clock: Clock) -> None:
        self._listeners = listeners
        self.clock = clock

    def tell(self, kind: str, step: Step | None = None, **detail: Any) -> None:
        if not self._listeners:
            return
        event = (
            Event(kind, self.clock.seconds(), detail=detail)
            if step is None
            else Event(kind, self.clock.seconds(), step.index, step.node, step.labels, detail)
        )
        for listener in self._listeners:
            listener(event)

    def settled(self, step: Step, outcome: Outcome) -> None:
        detail: dict[str, Any] = {"took": round(outcome.seconds, 6)}
        detail |= {"reason": outcome.reason} if outcome.reason else {}
        detail |= {"warnings": list(outcome.warnings)} if outcome.warnings else {}
        self.tell(outcome.state, step, **detail)
