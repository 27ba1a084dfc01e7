"""Drives an executor through a plan, tells what happens, and keeps what was asked for."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable
from contextlib import nullcontext
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Outcome, warnings_heard
from nodegraph.execute.events import Listener, Teller
from nodegraph.execute.executors import HowToRun, executor_of
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.results import Run
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.step_cache import Recall
from nodegraph.gc_pause import collecting_only_what_is_new
from nodegraph.plan import Plan
from nodegraph.store import Packer, Store

_UNNEEDED = Outcome("unneeded", reason="what needs it is stored", cause="unneeded")


@collecting_only_what_is_new()
def execute(
    plan: Plan,
    *,
    how: HowToRun | None = None,
    store: Store | None = None,
    keep: Iterable[str] = (),
    listeners: Iterable[Listener] = (),
) -> Run:
    """Run every step of a plan that is not stored; one that fails does not stop the others.

    Parameters
    ----------
    plan
    how
        Executor and number of calls at a time.
    store
        Where results are found and kept; nowhere by default.
    keep
        Nodes whose values stay in memory. Those of others are loaded, or computed again, when
        they are asked for.
    listeners
        Each is called with every `Event`, in this thread.
    """
    how = how or HowToRun()
    executor = executor_of(how, plan.graph.registry.hooks.executors)
    teller = Teller(tuple(listeners), plan)
    recall = Recall(plan, store) if store is not None else None
    try:
        known = recall.look_up() if recall is not None else {}
        for index, outcome in known.items():
            teller.settled(plan.steps[index], outcome)
        schedule = Schedule(
            plan,
            recall=recall,
            known=known,
            packer=store.packer
            if store is not None
            else Packer(plan.graph.registry.hooks.storages),
            keep=[index for name in keep for index in plan.cells.get(name, {}).values()],
            hears=teller,
        )
        teller.left = lambda: schedule.left
        with warnings_heard(), one_thread_each() if schedule.left else nullcontext():
            for step in executor(schedule, how):
                schedule.finish(*_checked(step, plan, how))
        if schedule.left:
            raise NodegraphError(
                f"executor {how.executor!r} ended with {schedule.left} of {len(plan.steps)} steps "
                "left to compute"
            )
    except BaseException:
        teller.interrupted()
        raise
    outcomes = {step.index: schedule.outcomes.get(step.index, _UNNEEDED) for step in plan.steps}
    run = Run(plan, outcomes, schedule.values, teller.seconds(), recall, schedule.packer)
    teller.finished(run.counts())
    return run


def _checked(step: Any, plan: Plan, how: HowToRun) -> tuple[int, Outcome]:
    """Return what an executor gave, which may be a plugin's, if it is a step and its outcome."""
    match step:
        case (int(index), Outcome() as outcome) if 0 <= index < len(plan.steps):
            return index, outcome
    raise NodegraphError(
        f"executor {how.executor!r} gave {reprlib.repr(step)} where the index of a step and its "
        "outcome are due"
    )
