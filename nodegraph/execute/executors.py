"""Where calls are made: an executor takes calls from a schedule and yields their outcomes."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from queue import SimpleQueue
from typing import Protocol

from nodegraph.execute.call import Call, Outcome, perform
from nodegraph.execute.schedule import Schedule


class Executor(Protocol):
    """Makes every call that a schedule hands out, and yields each step with its outcome.

    Whoever iterates gives the outcome to the schedule before asking for the next one, so that
    the executor sees what has become ready.
    """

    def __call__(self, schedule: Schedule, jobs: int) -> Iterator[tuple[int, Outcome]]:
        """Yield (step index, outcome) until the schedule has nothing left."""
        ...


def serial(schedule: Schedule, jobs: int = 1) -> Iterator[tuple[int, Outcome]]:
    """Make one call after the other, here."""
    while (call := schedule.next()) is not None:
        yield call.step, perform(call)


def threaded(schedule: Schedule, jobs: int) -> Iterator[tuple[int, Outcome]]:
    """Make up to `jobs` calls at a time, each in a thread of this process."""
    calls: SimpleQueue[Call | None] = SimpleQueue()
    outcomes: SimpleQueue[tuple[int, Outcome] | BaseException] = SimpleQueue()
    # daemons, because a node that never returns must not keep an interrupted program alive
    for _ in range(jobs):
        threading.Thread(target=_work, args=(calls, outcomes), daemon=True).start()
    running = 0
    try:
        while True:
            while running < jobs and (call := schedule.next()) is not None:
                calls.put(call)
                running += 1
            del call
            if not running:
                return
            finished = outcomes.get()
            if isinstance(finished, BaseException):
                raise finished
            running -= 1
            yield finished
    finally:
        for _ in range(jobs):
            calls.put(None)


def _work(
    calls: SimpleQueue[Call | None], outcomes: SimpleQueue[tuple[int, Outcome] | BaseException]
) -> None:
    while (call := calls.get()) is not None:
        try:
            outcomes.put((call.step, perform(call)))
        except BaseException as error:  # else whoever waits for the outcome waits for ever
            outcomes.put(error)
        del call


EXECUTORS: dict[str, Executor] = {"serial": serial, "threads": threaded}
