"""Which step may run next, with which values; values are dropped after their last reader."""

from __future__ import annotations

import heapq
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from typing import Any, Protocol

from nodegraph.execute.call import Call, Outcome, perform, skipped
from nodegraph.execute.step_cache import Recall
from nodegraph.node.ports import Absent, Across
from nodegraph.plan import Gathered, Output, Plan, Step, StepInput, absent_of
from nodegraph.store import Packer


def gathered(
    fed: Gathered, outcomes: Mapping[int, Outcome], value_of: Callable[[Output], Any]
) -> Across[Any]:
    """Return the values of a gathering port with their labels.

    Parameters
    ----------
    fed
        What the plan gathers.
    outcomes
        How the steps ended that feed it, all of them.
    value_of
        Returns the value of one output of a step that is done.
    """
    entries = []
    absent = list(absent_of(fed))
    for at, output in fed.entries:
        labels = dict(zip(fed.axes, at, strict=True))
        outcome = outcomes[output.step]
        if outcome.state == "done":
            entries.append((labels, value_of(output)))
        else:
            absent.append(Absent(labels, outcome.cause, outcome.reason))
    known = dict(zip(fed.axes, fed.known, strict=True))
    return Across(fed.axes, tuple(entries), tuple(absent), known)


class Hears(Protocol):
    """Who wants to know what becomes of steps."""

    def started(self, step: Step) -> None:
        """Hear that a step was handed out."""

    def settled(self, step: Step, outcome: Outcome) -> None:
        """Hear how a step ended."""


class Schedule:
    """Hands out calls in the order of the plan, and takes their outcomes back.

    A step is computed when it is wanted, or when one that is computed needs it; a stored result
    is loaded when it is needed, and only then.

    Parameters
    ----------
    plan
    recall
        Where results are stored.
    known
        How steps ended whose results are stored.
    packer
        How values are lent to readers, and travel.
    keep
        Steps whose values stay after their last reader.
    wanted
        Steps that are computed even if they are stored; by default all that nothing reads, and
        those to keep, are computed if they are not.
    hears
    """

    def __init__(
        self,
        plan: Plan,
        *,
        recall: Recall | None = None,
        known: Mapping[int, Outcome] | None = None,
        packer: Packer | None = None,
        keep: Iterable[int] = (),
        wanted: Iterable[int] | None = None,
        hears: Hears | None = None,
    ) -> None:
        self._plan = plan
        self._recall = recall
        self._hears = hears
        self.packer = packer or Packer()
        self._keep = frozenset(keep)
        self.outcomes = dict(known or {})
        self.values: dict[int, tuple[Any, ...]] = {}
        self._waiting: dict[int, int] = {}
        self._readers: dict[int, list[int]] = {}
        self._unread: dict[int, int] = {}
        self._ready: list[int] = []
        self._running: dict[str, int] = {}
        self._afresh: set[int] = set(wanted or ())
        self._partly: set[int] = set()
        self._demand([*(_unread(plan) if wanted is None else wanted), *self._keep])

    @property
    def plan(self) -> Plan:
        """The plan whose steps these are."""
        return self._plan

    @property
    def left(self) -> int:
        """How many steps are still to be settled, as far as is known."""
        return len(self._waiting)

    def next(self) -> Call | None:
        """Return the next call that can be made now, or None."""
        while self._ready:
            index = heapq.heappop(self._ready)
            step = self._plan.steps[index]
            if self._recall is not None and not self._is_first(step, self._recall.keys.of[index]):
                continue
            lost = [one for one in step.needed if not self._at_hand(step, one)]
            if lost:
                self._compute_again(index, lost)
                continue
            if self._hears is not None:
                self._hears.started(step)
            inputs = {port: self._value(fed) for port, fed in step.inputs.items()}
            method = step.method
            return Call(index, method.node, method.plugin, inputs, step.settings)
        return None

    def perform(self, call: Call) -> Outcome:
        """Make a call here, in any thread, and return its outcome."""
        return self.keep(call, perform(call))

    def keep(self, call: Call, outcome: Outcome) -> Outcome:
        """Store an outcome that was computed, in any thread, and return it."""
        if self._recall is None:
            return outcome
        return self._recall.save(self._plan.steps[call.step], outcome)

    def finish(self, index: int, outcome: Outcome) -> None:
        """Take an outcome, and settle the steps that it makes impossible."""
        pending = [(index, outcome)]
        while pending:
            at, found = pending.pop()
            self._settle(at, found)
            for reader in self._readers.pop(at, ()):
                self._waiting[reader] -= 1
                if not self._waiting[reader] and (known := self._freed(reader)) is not None:
                    pending.append((reader, known))

    def _demand(self, wanted: Iterable[int]) -> None:
        """Have steps computed that are not settled, with all that they need."""
        pending = [index for index in wanted if index not in self.outcomes]
        free: list[int] = []
        while pending:
            index = pending.pop()
            if index in self._waiting:
                continue
            waits = 0
            step = self._plan.steps[index]
            for needed in step.needed:
                self._unread[needed] = self._unread.get(needed, 0) + 1
                if needed not in self.outcomes:
                    waits += 1
                    self._readers.setdefault(needed, []).append(index)
                    pending.append(needed)
            self._waiting[index] = waits
            if not waits:
                free.append(index)
        for index in free:
            if (known := self._freed(index)) is not None:
                self.finish(index, known)

    def _freed(self, index: int) -> Outcome | None:
        """Return how a step ends that waits for nothing, if that is known; else have it run."""
        step = self._plan.steps[index]
        # what was stored when the step was demanded may have turned out not to be of use since
        forgotten = self._afresh and [one for one in step.needed if one not in self.outcomes]
        if forgotten:
            self._wait(index, forgotten)
            return None
        known = self._known(step)
        if known is None:
            heapq.heappush(self._ready, index)
        return known

    def _wait(self, reader: int, needed: Collection[int]) -> None:
        self._waiting[reader] = len(needed)
        for one in needed:
            self._readers.setdefault(one, []).append(reader)

    def _gives(self, reader: Step, needed: int) -> bool:
        """Whether a step is settled such that a reader can take what it needs from it."""
        outcome = self.outcomes.get(needed)
        if outcome is None:
            return False
        if self._recall is None or outcome.state != "done":
            return True
        if needed in self.values and needed not in self._partly:
            return True
        return self._recall.gives(
            needed, {one.position for one in reader.reads() if one.step == needed}
        )

    def _at_hand(self, reader: Step, needed: int) -> bool:
        """Whether what a reader takes from a step is in memory; load it if it is stored."""
        if self._recall is None or (needed in self.values and needed not in self._partly):
            return True
        if not self._gives(reader, needed):
            return False
        if needed in self.values or self.outcomes[needed].state != "done":
            return True
        values = self._recall.load(needed)
        if values is None:
            return False
        self.values[needed] = values
        if not self._recall.gives(needed, range(len(values))):
            self._partly.add(needed)
        return True

    def _is_first(self, step: Step, key: str) -> bool:
        """Whether no step of the same key is being computed; else wait for that one."""
        first = self._running.setdefault(key, step.index) if key else step.index
        if first == step.index or first in self.outcomes:
            self._running[key] = step.index
            return True
        self._wait(step.index, [first])
        return False

    def _compute_again(self, reader: int, lost: Collection[int]) -> None:
        """Have steps computed whose stored values cannot be used; a reader waits for them."""
        for needed in lost:
            self._forget(needed)
        self._wait(reader, lost)
        self._demand(lost)

    def _forget(self, index: int) -> None:
        """Have a step computed even if it is stored: what is stored cannot be used."""
        if self.outcomes.pop(index, None) is not None:
            self._afresh.add(index)
            self._drop(index)

    def _drop(self, index: int) -> None:
        self.values.pop(index, None)
        self._partly.discard(index)

    def _settle(self, index: int, outcome: Outcome) -> None:
        self._waiting.pop(index, None)
        if outcome.values:
            if self._unread.get(index) or index in self._keep:
                self.values[index] = outcome.values
            outcome.values = ()  # else they would live as long as the outcome
        self.outcomes[index] = outcome
        for needed in self._plan.steps[index].needed:
            if self._unread.get(needed):
                self._unread[needed] -= 1
                if not self._unread[needed] and (
                    needed not in self._keep or needed in self._partly
                ):
                    self._drop(needed)
        if self._hears is not None:
            self._hears.settled(self._plan.steps[index], outcome)

    def _known(self, step: Step) -> Outcome | None:
        """Return how a step ends, if that is known without computing it."""
        stopped = skipped(self._plan, step, self.outcomes)
        if stopped is None and self._recall is not None:
            afresh = step.index in self._afresh
            return self._recall.look_again(step, self.outcomes, afresh=afresh)
        return stopped

    def _value(self, fed: StepInput) -> Any:
        if isinstance(fed, Output):
            return self._lent(fed)
        return gathered(fed, self.outcomes, self._lent)

    def _lent(self, output: Output) -> Any:
        return self.packer.lend(self.values[output.step][output.position])


def _unread(plan: Plan) -> Iterator[int]:
    """Yield the steps that nothing reads."""
    read = {needed for step in plan.steps for needed in step.needed}
    return (step.index for step in plan.steps if step.index not in read)
