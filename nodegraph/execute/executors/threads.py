"""Several calls at a time, each in a thread of this process."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from queue import SimpleQueue

from nodegraph.execute.call import Call, Outcome
from nodegraph.execute.executors.base import HowToRun
from nodegraph.execute.numeric_threads import one_thread_here
from nodegraph.execute.schedule import Schedule

_Calls = SimpleQueue[Call | None]
_Outcomes = SimpleQueue[tuple[int, Outcome] | BaseException]


def threads(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make several calls at a time, each in a thread of this process."""
    calls: _Calls = SimpleQueue()
    outcomes: _Outcomes = SimpleQueue()
    jobs = min(how.at_a_time, len(schedule.plan.steps))
    # daemons, because a node that never returns must not keep an interrupted program alive
    for _ in range(jobs):
        work = threading.Thread(target=_work, args=(schedule.perform, calls, outcomes), daemon=True)
        work.start()
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


def _work(perform: Callable[[Call], Outcome], calls: _Calls, outcomes: _Outcomes) -> None:
    with one_thread_here():
        while (call := calls.get()) is not None:
            try:
                outcomes.put((call.step, perform(call)))
            except BaseException as error:  # else whoever waits for the outcome waits for ever
                outcomes.put(error)
            del call
