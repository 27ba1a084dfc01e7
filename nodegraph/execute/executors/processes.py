"""Several calls at a time, each in a process of its own on this machine."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from queue import SimpleQueue

from nodegraph.execute.call import Call, Outcome
from nodegraph.execute.executors.base import HowToRun
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.worker.client import Asker, Child, EndedError
from nodegraph.execute.worker.protocol import LACKING, Answer, Question
from nodegraph.state import State

_Calls = SimpleQueue[Call | None]
_Outcomes = SimpleQueue[tuple[int, Outcome] | BaseException]


def processes(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make several calls at a time, each in a process of its own.

    A call whose node or values cannot go to another process is made here. A process that dies
    fails the step that it computed; another takes its place.
    """
    calls: _Calls = SimpleQueue()
    outcomes: _Outcomes = SimpleQueue()
    asker = Asker(schedule, shares_files=True, are_new=True)
    slots: list[_Slot] = []
    running = 0
    try:
        while True:
            while running < how.at_a_time and (call := schedule.next()) is not None:
                calls.put(call)
                running += 1
                if running > len(slots):
                    slots.append(_Slot(schedule, asker, calls, outcomes))
            del call
            if not running:
                break
            finished = outcomes.get()
            if isinstance(finished, BaseException):
                raise finished
            running -= 1
            yield finished
            del finished  # its values, while the next outcome is waited for
    except BaseException:
        for slot in slots:
            slot.give_up()
        raise
    finally:
        for _ in slots:
            calls.put(None)
        for slot in slots:
            slot.join()


class _Slot:
    """A thread that has a process to make calls in, and makes here what cannot be made there."""

    def __init__(
        self, schedule: Schedule, asker: Asker, calls: _Calls, outcomes: _Outcomes
    ) -> None:
        self._schedule = schedule
        self._asker = asker
        self._calls = calls
        self._outcomes = outcomes
        self._child: Child | None = None
        self._lock = threading.Lock()
        self._given_up = False
        self._busy_here = False
        # a daemon, because a node that never returns must not keep an interrupted program alive
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._thread.start()

    def give_up(self) -> None:
        """End the process at once, whatever it does."""
        with self._lock:
            self._given_up = True
            if self._child is not None:
                self._child.kill()

    def join(self) -> None:
        """Wait until the process is gone."""
        if not (self._given_up and self._busy_here):
            self._thread.join()

    def _work(self) -> None:
        while (call := self._calls.get()) is not None and not self._given_up:
            try:
                self._outcomes.put((call.step, self._outcome(call)))
            except BaseException as error:  # else whoever waits for the outcome waits for ever
                self._outcomes.put(error)
            del call
        if self._child is not None:
            self._child.close()

    def _outcome(self, call: Call) -> Outcome:
        question = self._asker.question(call)
        if question is None:
            return self._here(call)
        try:
            answer = self._answer(question)
        except EndedError as ended:
            reason = f"the process that computed it {ended}"
            return self._schedule.keep(call, Outcome(State.FAILED, reason=reason))
        # a process of this machine lacks a node only if it cannot be imported at all
        outcome = None if answer.kind == LACKING else self._asker.outcome(answer, "a process")
        return self._here(call) if outcome is None else self._schedule.keep(call, outcome)

    def _here(self, call: Call) -> Outcome:
        self._busy_here = True
        try:
            return self._schedule.perform(call)
        finally:
            self._busy_here = False

    def _answer(self, question: Question) -> Answer:
        child = self._living_child()
        try:
            return child.ask(question)
        except EndedError:
            self._child = None
            child.close()
            raise

    def _living_child(self) -> Child:
        with self._lock:
            if self._given_up:
                raise EndedError("was given up")
            if self._child is not None and not self._child.is_alive:
                self._child.close()
                self._child = None
            if self._child is None:
                self._child = Child()
            return self._child
