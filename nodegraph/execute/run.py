"""Drives an executor through a plan, reports events, and returns the finished run."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable
from contextlib import nullcontext
from dataclasses import asdict

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import collecting_warnings
from nodegraph.execute.events import EventLog, Listener
from nodegraph.execute.executor import HowToRun, executor_of
from nodegraph.execute.in_turn import in_turn
from nodegraph.execute.interruption import interruptible
from nodegraph.execute.numeric_threads import one_thread_each
from nodegraph.execute.outcome import Outcome
from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.settings import RunSettings
from nodegraph.plan import Plan
from nodegraph.plugin.formats import formats_of
from nodegraph.state import State
from nodegraph.store import Packer, Store

_SECONDS = "seconds"
"""The name under which a store remembers how long a step of each node takes."""


def execute(
    plan: Plan,
    *,
    how: HowToRun | None = None,
    store: Store | None = None,
    keep: Iterable[str] = (),
    listeners: Iterable[Listener] = (),
    settings: RunSettings | None = None,
) -> Run:
    """Run every step of a plan that is not stored; a step that fails does not stop the others.

    Parameters
    ----------
    plan
    how
        Executor and number of calls at a time.
    store
        Where results are looked up and stored; nowhere by default.
    keep
        Nodes whose values stay in memory. Other values are loaded, or computed again, when they
        are needed.
    listeners
        Each is called with every `Event`, in this thread.
    settings
        The settings with which the run is started; by default its graph alone.

    Raises
    ------
    NodegraphError
        If there is no such executor, or it ends before it has given every outcome.
    """
    how = how or HowToRun()
    executor = executor_of(how, plan.graph.registry)
    settings = settings or RunSettings(plan.graph.spec.file)
    folder = str(plan.graph.choices.folder.absolute())
    log = EventLog(tuple(listeners), plan, {"settings": asdict(settings), "folder": folder})
    try:
        cache = StoredSteps(plan, store) if store is not None else None
        known = cache.known if cache is not None else {}
        for index, outcome in known.items():
            log.settled(plan.steps[index], outcome)
        schedule = Schedule(
            plan,
            cache=cache,
            known=known,
            packer=store.packer if store is not None else Packer(plan.graph.registry.hooks.kinds),
            keep=[index for name in keep for index in plan.cells.get(name, {}).values()],
            observer=log if log.listeners else None,
            timeout=how.timeout,
        )
        earlier = store.recall(_SECONDS) if store is not None and schedule.left else {}
        log.begin(schedule.left, map(plan.steps.__getitem__, schedule.left), earlier)
        registry = formats_of(plan.graph.registry)
        threads = one_thread_each() if schedule.left else nullcontext()
        with collecting_warnings(), registry, threads, in_turn(), interruptible():
            for result in executor(schedule, how):
                schedule.finish(*_checked(result, plan, how))
        if schedule.left:
            raise NodegraphError(
                f"executor {how.executor!r} ended with {len(schedule.left)} of {len(plan.steps)} "
                "steps left to compute"
            )
        if store is not None and (seconds := log.typical_seconds()):
            store.remember(_SECONDS, earlier | seconds)
    except BaseException:
        log.interrupted()
        raise
    outcomes = {
        step.index: schedule.outcomes.get(step.index) or _unneeded(step.index, cache)
        for step in plan.steps
    }
    run = Run(plan, outcomes, schedule.values, log.seconds(), cache, schedule.packer, settings)
    log.finished(run.counts)
    return run


def _checked(result: object, plan: Plan, how: HowToRun) -> tuple[int, Outcome]:
    """Return the step and the outcome that an executor yielded, possibly a plugin's."""
    if isinstance(result, tuple) and len(result) == 2:  # `match` would take five times as long
        index, outcome = result
        if isinstance(index, int) and isinstance(outcome, Outcome) and 0 <= index < len(plan.steps):
            return index, outcome
    raise NodegraphError(
        f"executor {how.executor!r} yielded {reprlib.repr(result)}; expected the index of a step "
        "and its outcome"
    )


def _unneeded(index: int, cache: StoredSteps | None) -> Outcome:
    key = cache.expected_key(index) if cache is not None else ""
    return Outcome(State.UNNEEDED, reason="everything that reads it is stored", key=key)
