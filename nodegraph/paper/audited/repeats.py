"""One call of a node made again: here, with more threads, in another process."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.execute.call import Call, Outcome, perform, warnings_heard
from nodegraph.execute.elsewhere.asking import Asker
from nodegraph.execute.elsewhere.child import Child, EndedError
from nodegraph.execute.elsewhere.letters import LACKING, NOT_SENT
from nodegraph.execute.one_thread import one_thread_each
from nodegraph.execute.recall import Recall
from nodegraph.execute.schedule import Schedule
from nodegraph.paper.audited.drift import Given
from nodegraph.ports import Across
from nodegraph.store import DamagedEntry, Packer, Unstorable

SEVERAL = 2
"""Threads of numerical libraries, where one is what each call of a run gets."""


@dataclass(frozen=True)
class Case:
    """A call that can be made again.

    Attributes
    ----------
    call : Call
    marks : mapping of port to str
        A digest of each input as the node should leave it; an empty one of what cannot be taken
        apart.
    """

    call: Call
    marks: Mapping[str, str]


class Repeats:
    """Makes the calls of a finished run again, each as often as one likes with the same inputs.

    Use it in a ``with`` statement, at whose end the other process ends.

    Parameters
    ----------
    run
        With a store, from which come the inputs.
    """

    def __init__(self, run: Run) -> None:
        assert run.recall is not None, "an audit needs a store"
        self._run = run
        # another one, which takes what the run has just stored for found, and computes no less
        self._recall = Recall(run.plan, run.recall.store)
        self._stored = self._recall.look_up()
        schedule = Schedule(run.plan, packer=run.packer, wanted=[])
        self._asker = Asker(schedule, shares_files=True, are_new=True)
        self._child: Child | None = None
        self._open = ExitStack()

    def __enter__(self) -> Repeats:
        self._open.enter_context(warnings_heard())
        self._open.enter_context(one_thread_each())
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()
        if self._child is not None:
            self._child.close() if kind is None else self._child.kill()

    def case(self, index: int) -> Case:
        """Return the call of a step, with the inputs that the run gave it.

        Raises
        ------
        NodegraphError
            If they are not stored any more and cannot be computed again.
        """
        ended = self._run.outcomes.items()
        without = {at: one for at, one in ended if one.state in ("refused", "failed", "skipped")}
        known = {at: one for at, one in (self._stored | without).items() if at != index}
        schedule = Schedule(
            self._run.plan,
            recall=self._recall,
            known=known,
            packer=self._run.packer,
            wanted=[index],
        )
        while (call := schedule.next()) is not None:
            if call.step == index:
                return Case(call, _marks(call.inputs, self._run.packer))
            schedule.finish(call.step, perform(call))
        reason = schedule.outcomes[index].reason
        raise NodegraphError(f"what feeds it cannot be computed again: {reason}")

    def here(self, case: Case, threads: int = 1) -> tuple[Outcome, str]:
        """Make a call in this process; return its outcome and which of its inputs it changed."""
        packer = self._run.packer
        inputs = {port: _lent(value, packer) for port, value in case.call.inputs.items()}
        with numeric_threads(threads):
            outcome = perform(replace(case.call, inputs=inputs))
        after = _marks(inputs, packer)
        return outcome, ", ".join(port for port in inputs if case.marks[port] != after[port])

    def elsewhere(self, case: Case) -> Outcome | str:
        """Make a call in another process; return its outcome, or why it cannot be made there.

        Raises
        ------
        EndedError
            If the process dies of it.
        """
        question = self._asker.question(case.call)
        if question is None:
            return "the node or what feeds it cannot be sent there"
        if self._child is None or not self._child.is_alive:
            self._child = Child()
        try:
            answer = self._child.ask(question)
        except EndedError:
            self._child.close()
            self._child = None
            raise
        if answer.kind in (LACKING, NOT_SENT):
            return answer.outcome.reason
        outcome = self._asker.outcome(answer, "a process")
        return "what comes back cannot be read" if outcome is None else outcome

    def given(self, outcome: Outcome) -> Given:
        """Return what a call gave, such that it can be compared."""
        return Given.of(outcome.values, self._run.packer)

    def stored(self, index: int) -> Given | None:
        """Return what the store has of a step."""
        key = self._recall.keys.of[index]
        entry = self._recall.store.find(key) if key else None
        if entry is None or entry.state != "done":
            return None
        try:
            values = self._recall.store.load(entry)
        except DamagedEntry:
            return None
        return replace(Given.of(values, self._run.packer), digests=entry.digests)


@contextmanager
def numeric_threads(count: int) -> Iterator[None]:
    """Have numerical libraries use so many threads for what is called in this thread."""
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=count), _numba_threads(count):
        yield


@contextmanager
def _numba_threads(count: int) -> Iterator[None]:
    numba = sys.modules.get("numba")
    if numba is None:
        yield
        return
    before = numba.get_num_threads()
    numba.set_num_threads(min(count, numba.config.NUMBA_NUM_THREADS))
    try:
        yield
    finally:
        numba.set_num_threads(before)


def _lent(value: Any, packer: Packer) -> Any:
    """Return what one call gets of a value, which a later call gets as it is now."""
    if not isinstance(value, Across):
        return packer.lend(value)
    entries = tuple((labels, packer.lend(one)) for labels, one in value)
    return replace(value, entries=entries)


def _marks(inputs: Mapping[str, Any], packer: Packer) -> dict[str, str]:
    return {port: _mark(value, packer) for port, value in inputs.items()}


def _mark(value: Any, packer: Packer) -> str:
    try:
        return packer.digest(value)
    except Unstorable:
        return ""
