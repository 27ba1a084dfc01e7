"""Which step may run next, with which values; values are dropped after their last reader."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from nodegraph.execute.call import Call, Outcome, perform
from nodegraph.plan import Gathered, Output, Plan, Step, StepInput, absent_of
from nodegraph.ports import Absent, Across


class Schedule:
    """Hands out calls in the order of the plan, and takes their outcomes back.

    Parameters
    ----------
    plan
    keep
        Steps whose values stay after their last reader.
    wanted
        Steps to compute, with what they need; all of them by default.
    on_start
        Called with each step that is handed out.
    """

    def __init__(
        self,
        plan: Plan,
        *,
        keep: Iterable[int] = (),
        wanted: Iterable[int] | None = None,
        on_start: Callable[[Step], None] = lambda step: None,
    ) -> None:
        self._plan = plan
        self._on_start = on_start
        self._keep = set(keep)
        self.outcomes: dict[int, Outcome] = {}
        self.values: dict[int, tuple[Any, ...]] = {}
        self.steps = _with_needs(plan, wanted)
        self._waiting: dict[int, int] = {}
        self._readers: dict[int, list[int]] = {index: [] for index in self.steps}
        self._unread: dict[int, int] = {}
        self._ready: list[int] = []
        self._link()

    def next(self) -> Call | None:
        """Return the next call that can be made now, or None."""
        if not self._ready:
            return None
        step = self._plan.steps[heapq.heappop(self._ready)]
        self._on_start(step)
        inputs = {port: self._value(fed) for port, fed in step.inputs.items()}
        return Call(step.index, step.method.node, step.method.plugin, inputs, step.settings)

    def perform(self, call: Call) -> Outcome:
        """Make a call here, in any thread, and return its outcome."""
        return self.keep(call, perform(call))

    def keep(self, call: Call, outcome: Outcome) -> Outcome:
        """Take an outcome that was computed elsewhere, and return it."""
        return outcome

    def finish(self, index: int, outcome: Outcome) -> list[tuple[Step, Outcome]]:
        """Take an outcome; return it with those of the steps that it makes impossible."""
        settled: list[tuple[Step, Outcome]] = []
        pending = [(index, outcome)]
        while pending:
            at, found = pending.pop()
            self._settle(at, found)
            settled.append((self._plan.steps[at], found))
            for reader in self._readers[at]:
                self._waiting[reader] -= 1
                if not self._waiting[reader]:
                    stopped = self._stopped(self._plan.steps[reader])
                    if stopped is None:
                        heapq.heappush(self._ready, reader)
                    else:
                        pending.append((reader, stopped))
        return settled

    def _link(self) -> None:
        for index in self.steps:
            needs = set(self._plan.steps[index].needs())
            self._waiting[index] = len(needs)
            for needed in needs:
                self._readers[needed].append(index)
            if not needs:
                self._ready.append(index)
        self._unread = {index: len(readers) for index, readers in self._readers.items()}
        heapq.heapify(self._ready)

    def _settle(self, index: int, outcome: Outcome) -> None:
        if outcome.state == "done" and (self._unread[index] or index in self._keep):
            self.values[index] = outcome.values
        self.outcomes[index] = Outcome(
            outcome.state, (), outcome.reason, outcome.trace, outcome.warnings,
            outcome.seconds, outcome.cause,
        )  # fmt: skip
        for needed in set(self._plan.steps[index].needs()):
            self._unread[needed] -= 1
            if not self._unread[needed] and needed not in self._keep:
                self.values.pop(needed, None)

    def _stopped(self, step: Step) -> Outcome | None:
        """Return why a step cannot run, if one that it needs has no value."""
        for fed in step.inputs.values():
            outputs = [one for _, one in fed.entries] if isinstance(fed, Gathered) else [fed]
            lacking = [one for one in outputs if self.outcomes[one.step].state != "done"]
            if isinstance(fed, Gathered) and len(lacking) < len(outputs):
                continue
            if lacking:
                return self._because(lacking[0])
        return None

    def _because(self, output: Output) -> Outcome:
        cause = self.outcomes[output.step]
        name = self._plan.steps[output.step].name
        reason = (
            cause.reason if cause.state == "skipped" else f"{name} {cause.state}: {cause.reason}"
        )
        return Outcome("skipped", reason=reason, cause=cause.cause)

    def _value(self, fed: StepInput) -> Any:
        if isinstance(fed, Output):
            return self.values[fed.step][fed.position]
        entries = []
        absent = list(absent_of(fed))
        for at, output in fed.entries:
            labels = dict(zip(fed.axes, at, strict=True))
            outcome = self.outcomes[output.step]
            if outcome.state == "done":
                entries.append((labels, self.values[output.step][output.position]))
            else:
                absent.append(Absent(labels, outcome.cause, outcome.reason))
        return Across(fed.axes, tuple(entries), tuple(absent))


def _with_needs(plan: Plan, wanted: Iterable[int] | None) -> Mapping[int, None]:
    if wanted is None:
        return dict.fromkeys(range(len(plan.steps)))
    found = set(wanted)
    pending = list(found)
    while pending:
        for needed in plan.steps[pending.pop()].needs():
            if needed not in found:
                found.add(needed)
                pending.append(needed)
    return dict.fromkeys(sorted(found))
