"""The order of steps: which may run next, and which are computed again."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from typing import Protocol

from nodegraph.execute.call import Call, perform
from nodegraph.execute.outcome import Outcome, failure, skipped
from nodegraph.execute.resume import StoredSteps
from nodegraph.execute.value_pool import ValuePool
from nodegraph.gc_pause import gc_paused
from nodegraph.plan import Plan, Step
from nodegraph.store import Packer


class Observer(Protocol):
    """Follows what becomes of steps."""

    def started(self, step: Step) -> None:
        """Note that a step was handed out."""

    def settled(self, step: Step, outcome: Outcome) -> None:
        """Note how a step ended."""


class Schedule:
    """Hands out calls in the order of the plan, and takes their outcomes back.

    A step is computed if it is wanted, or if a step that is computed needs it; a stored result is
    loaded only when it is needed.

    Parameters
    ----------
    plan
    cache
        Where results are stored.
    known
        How steps ended that need not be computed.
    packer
        How values are lent to readers, and sent to other processes.
    keep
        Steps whose values stay after their last reader.
    wanted
        Steps that are computed even if they are stored; by default, those that nothing reads, and
        those to keep, are computed unless they are stored.
    observer
    timeout
        Seconds that a step may take.

    Attributes
    ----------
    plan : Plan
    registry : Registry
        The plugins that define the nodes.
    packer : Packer
    outcomes : mapping of step index to Outcome
    """

    def __init__(
        self,
        plan: Plan,
        *,
        cache: StoredSteps | None = None,
        known: Mapping[int, Outcome] | None = None,
        packer: Packer | None = None,
        keep: Iterable[int] = (),
        wanted: Iterable[int] | None = None,
        observer: Observer | None = None,
        timeout: float | None = None,
    ) -> None:
        self.plan = plan
        self.registry = plan.graph.registry
        self.packer = packer or Packer()
        self.outcomes = dict(known or {})
        self._cache = cache
        self._pool = ValuePool(self.packer, cache, frozenset(keep))
        self._observer = observer
        self._timeout = timeout
        # a heap of steps with their keys: calls are handed out in the order of the plan,
        # whichever of them became possible first
        self._ready: list[tuple[int, str]] = []
        self._waiting: dict[int, int] = {}  # how many steps each still waits for
        self._readers: dict[int, list[int]] = {}  # which steps wait for each
        self._first_of_key: dict[str, int] = {}
        self._recompute = set(wanted or ())  # not to be taken from the store
        self._demand([*(_last_steps(plan) if wanted is None else wanted), *self._pool.keep])

    @property
    def values(self) -> dict[int, tuple[object, ...]]:
        """Values of the steps to keep, and of those that are still to be read."""
        return self._pool.values

    @property
    def left(self) -> Collection[int]:
        """The steps that are still to be settled, as far as is known."""
        return self._waiting.keys()

    def next(self) -> Call | None:
        """Return the next call that can be made now, or None."""
        while self._ready:
            index, key = heapq.heappop(self._ready)
            step = self.plan.steps[index]
            if key and not self._is_first_of_key(index, key):
                continue
            if lost := self._pool.load(step, self.outcomes):
                self._compute_again(index, lost)
                continue
            if self._observer is not None:
                self._observer.started(step)
            inputs = self._pool.take(step, self.outcomes)
            method = step.method
            return Call(
                index,
                method.node,
                method.plugin,
                inputs,
                step.settings,
                key,
                self.registry,
                method.node.limit(self._timeout),
            )
        return None

    def perform(self, call: Call) -> Outcome:
        """Make a call in this process, in any thread, and return its outcome.

        A node that does not come with this package gets copies: whatever it does with them, other
        steps read what was stored.
        """
        if call.plugin not in self.registry.shipped:
            copy = self.packer.copy
            try:
                call.inputs = {port: copy(value) for port, value in call.inputs.items()}
                if call.settings:
                    call.settings = {name: copy(value) for name, value in call.settings.items()}
            except Exception as error:
                failed = failure(call.node, error, "its inputs cannot be copied")
                return replace(failed, key=call.key)
        return self.keep(call, perform(call))

    def keep(self, call: Call, outcome: Outcome) -> Outcome:
        """Store an outcome that was computed, in any thread, and return it.

        A step fails if one of its values cannot be copied for readers, or cannot be stored.
        """
        what = "what it returned cannot be copied for those that read it"
        try:
            for value in outcome.values:
                self.packer.lend(value)
            what = "what it returned cannot be stored"
            if self._cache is not None:
                outcome = self._cache.save(self.plan.steps[call.step], call.key, outcome)
        except Exception as error:
            failed = failure(call.node, error, what)
            return replace(failed, warnings=outcome.warnings, seconds=outcome.seconds, key=call.key)
        return outcome

    def finish(self, index: int, outcome: Outcome) -> None:
        """Take an outcome, and settle the steps that it makes impossible."""
        pending = [(index, outcome)]
        while pending:
            index, outcome = pending.pop()
            self._settle(index, outcome)
            for reader in self._readers.pop(index, ()):
                self._waiting[reader] -= 1
                if not self._waiting[reader] and (known := self._release(reader)) is not None:
                    pending.append((reader, known))

    @gc_paused()
    def _demand(self, wanted: Iterable[int]) -> None:
        """Have steps computed that are not settled, with all that they need."""
        pending = [index for index in wanted if index not in self.outcomes]
        free: list[int] = []
        while pending:
            index = pending.pop()
            if index in self._waiting:
                continue
            unsettled = 0
            step = self.plan.steps[index]
            self._pool.expect(step)
            for needed in step.needed:
                if needed not in self.outcomes:
                    unsettled += 1
                    self._readers.setdefault(needed, []).append(index)
                    pending.append(needed)
            self._waiting[index] = unsettled
            if not unsettled:
                free.append(index)
        for index in free:
            if (known := self._release(index)) is not None:
                self.finish(index, known)

    def _release(self, index: int) -> Outcome | None:
        """Return how a step ended that waits for nothing, if that is known; else have it run."""
        step = self.plan.steps[index]
        # a stored result that it needs may have turned out to be unusable since it was demanded
        forgotten = self._recompute and [at for at in step.needed if at not in self.outcomes]
        if forgotten:
            self._wait(index, forgotten)
            return None
        known = skipped(self.plan, step, self.outcomes)
        key = ""
        if self._cache is not None:
            if known is not None:
                known.key = self._cache.expected_key(index)
            else:
                key = self._cache.key(step, self.outcomes)
                known = self._cache.look_again(step, key, whole=index in self._recompute)
        if known is None:
            heapq.heappush(self._ready, (index, key))
        else:
            self._pool.release(step)
        return known

    def _wait(self, reader: int, needed: Collection[int]) -> None:
        self._waiting[reader] = len(needed)
        for index in needed:
            self._readers.setdefault(index, []).append(reader)

    def _is_first_of_key(self, index: int, key: str) -> bool:
        """Whether no other step of the same key is being computed; else wait for that one."""
        # steps of one key have one result: the others find it stored once the first is done
        first = self._first_of_key.setdefault(key, index)
        if first == index or first in self.outcomes:
            self._first_of_key[key] = index
            return True
        self._wait(index, [first])
        return False

    def _compute_again(self, reader: int, lost: Collection[int]) -> None:
        """Have steps computed whose stored values cannot be used; a reader waits for them."""
        for needed in lost:
            if self.outcomes.pop(needed, None) is not None:
                self._recompute.add(needed)
                self._pool.drop(needed)
        self._wait(reader, lost)
        self._demand(lost)

    def _settle(self, index: int, outcome: Outcome) -> None:
        self._waiting.pop(index, None)
        if outcome.values:
            self._pool.add(index, outcome.values)
            outcome.values = ()  # else they would live as long as the outcome
        self.outcomes[index] = outcome
        if self._observer is not None:
            self._observer.settled(self.plan.steps[index], outcome)


def _last_steps(plan: Plan) -> Iterator[int]:
    """Yield the steps that nothing reads."""
    read = {needed for step in plan.steps for needed in step.needed}
    return (step.index for step in plan.steps if step.index not in read)
