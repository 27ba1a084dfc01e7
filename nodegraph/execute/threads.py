"""Executors of this process: one call after the other, or several at a time in threads."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from functools import partial
from queue import Empty, SimpleQueue

from nodegraph.execute.call import Call, Outcome, timed_out
from nodegraph.execute.executor import HowToRun, Schedule
from nodegraph.execute.numeric_threads import one_thread_here

Calls = SimpleQueue[Call | None]
Results = SimpleQueue[tuple[int, Outcome] | BaseException]


def serial(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make one call after the other, in this thread; those with a time limit in another."""
    while (call := schedule.next()) is not None:
        yield call.step, in_time(schedule.perform, call)


def in_time(perform: Callable[[Call], Outcome], call: Call) -> Outcome:
    """Make a call, and return its outcome, or that it takes too long.

    A thread cannot be ended: a call that takes too long continues until the program ends.
    """
    if call.timeout is None:
        return perform(call)
    calls: Calls = SimpleQueue()
    results: Results = SimpleQueue()
    calls.put(call)
    calls.put(None)
    threading.Thread(target=_work, args=(perform, calls, results), daemon=True).start()
    try:
        result = results.get(timeout=call.timeout)
    except Empty:
        return timed_out(call)
    if isinstance(result, BaseException):
        raise result
    return result[1]


def threads(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make several calls at a time, each in a thread of this process."""

    def start(calls: Calls, results: Results) -> None:
        # daemons: a node that never returns must not keep the program alive
        arguments = (partial(in_time, schedule.perform), calls, results)
        threading.Thread(target=_work, args=arguments, daemon=True).start()

    return distribute(schedule, how.at_a_time, start)


def _work(perform: Callable[[Call], Outcome], calls: Calls, results: Results) -> None:
    with one_thread_here():
        make_calls(perform, calls, results)


def distribute(
    schedule: Schedule, at_a_time: int, start: Callable[[Calls, Results], None]
) -> Iterator[tuple[int, Outcome]]:
    """Hand the calls of a schedule to workers, and yield their results.

    Parameters
    ----------
    schedule
    at_a_time
    start
        Starts a worker, which takes calls from one queue until it gets None, and puts their
        results, or what must end the run, into the other. No more are started than are needed.
    """
    calls: Calls = SimpleQueue()
    results: Results = SimpleQueue()
    started = running = 0
    try:
        while True:
            while running < at_a_time and (call := schedule.next()) is not None:
                calls.put(call)
                running += 1
                if running > started:
                    start(calls, results)
                    started += 1
            del call  # else its inputs would stay in memory while a result is waited for
            if not running:
                return
            result = results.get()
            if isinstance(result, BaseException):
                raise result
            running -= 1
            yield result
            del result
    finally:
        for _ in range(started):
            calls.put(None)


def make_calls(perform: Callable[[Call], Outcome], calls: Calls, results: Results) -> None:
    """Make the calls of a queue, until it gives None."""
    while (call := calls.get()) is not None:
        try:
            results.put((call.step, perform(call)))
        except BaseException as error:  # else the run would wait for a result for ever
            results.put(error)
        del call
