"""Executors of this process: one call after the other, or several at a time in threads."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice
from queue import Empty, SimpleQueue

from nodegraph.execute.call import Call, timed_out
from nodegraph.execute.executor import Calls, HowToRun
from nodegraph.execute.numeric_threads import one_thread_here
from nodegraph.execute.outcome import Outcome

_SECONDS_BETWEEN_COUNTS = 0.5
"""Seconds that results are waited for before the number of calls at a time is asked for again."""
_SECONDS_TO_GIVE_UP = 1.0
"""Seconds in which calls that were given up end; one in this process may never end."""

_Result = tuple[int, Outcome] | BaseException


def serial(schedule: Calls, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make one call after the other, in this thread; those with a time limit in another."""
    while (call := schedule.next()) is not None:
        yield call.step, in_time(schedule.perform, call)


def threads(schedule: Calls, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make several calls at a time, each in a thread of this process."""
    count = how.at_a_time  # asked for once: the operating system counts for longer than steps take
    perform = partial(in_time, schedule.perform)
    return side_by_side(schedule, lambda: count, perform, alone_here=True)


def in_time(perform: Callable[[Call], Outcome], call: Call) -> Outcome:
    """Make a call, and return its outcome, or that it takes too long.

    A thread cannot be ended: a call that takes too long continues until the program ends.
    """
    if call.timeout is None:
        return perform(call)
    results: SimpleQueue[_Result] = SimpleQueue()
    arguments = (perform, iter([call]), results)
    threading.Thread(target=_work, args=arguments, daemon=True).start()
    try:
        result = results.get(timeout=call.timeout)
    except Empty:
        return timed_out(call)
    if isinstance(result, BaseException):
        raise result
    return result[1]


def side_by_side(
    schedule: Calls,
    at_a_time: Callable[[], int],
    perform: Callable[[Call], Outcome],
    *,
    give_up: Callable[[], None] | None = None,
    alone_here: bool = False,
) -> Iterator[tuple[int, Outcome]]:
    """Make the calls of a schedule in threads, several at a time, and yield their outcomes.

    Parameters
    ----------
    schedule
    at_a_time
        Returns how many; asked again before each call, and from time to time.
    perform
        Makes one call, wherever it likes, and returns when that has ended. What it raises ends
        the run.
    give_up
        Called when the run ends early: has calls end that are being made.
    alone_here
        Whether a call beside which no other can be made is made in this thread, which is faster.
    """
    threads = _Threads(perform)
    try:
        while True:
            count = max(at_a_time() - threads.running, 0)
            ready = list(islice(iter(schedule.next, None), count))
            if alone_here and not threads.running and len(ready) == 1:
                call = ready.pop()
                yield call.step, perform(call)
                del call
                continue
            while ready:  # no name keeps a call, and with it the inputs, while a result is awaited
                threads.make(ready.pop(0))
            if not threads.running:
                return
            if (result := threads.result()) is not None:
                yield result
                del result
    except BaseException:
        if give_up is not None:
            give_up()
        raise
    finally:
        threads.end(wait=give_up is not None)


class _Threads:
    """Threads that make calls; no more are started than are needed."""

    def __init__(self, perform: Callable[[Call], Outcome]) -> None:
        self.running = 0
        self._perform = perform
        self._started: list[threading.Thread] = []
        self._calls: SimpleQueue[Call | None] = SimpleQueue()
        self._results: SimpleQueue[_Result] = SimpleQueue()

    def make(self, call: Call) -> None:
        self._calls.put(call)
        self.running += 1
        if self.running > len(self._started):
            arguments = (self._perform, iter(self._calls.get, None), self._results)
            # a daemon: a node that never returns must not keep the program alive
            thread = threading.Thread(target=_work, args=arguments, daemon=True)
            self._started.append(thread)
            thread.start()

    def result(self) -> tuple[int, Outcome] | None:
        """Return the next result, or None after some time without one."""
        try:
            result = self._results.get(timeout=_SECONDS_BETWEEN_COUNTS)
        except Empty:
            return None
        if isinstance(result, BaseException):
            raise result
        self.running -= 1
        return result

    def end(self, *, wait: bool) -> None:
        for _ in self._started:
            self._calls.put(None)
        end = time.monotonic() + (_SECONDS_TO_GIVE_UP if wait else 0.0)
        for thread in self._started:
            if thread.is_alive():  # an interrupt may have come while one was being started
                thread.join(max(end - time.monotonic(), 0.0))


def _work(
    perform: Callable[[Call], Outcome], calls: Iterator[Call], results: SimpleQueue[_Result]
) -> None:
    with one_thread_here():
        for call in calls:
            try:
                results.put((call.step, perform(call)))
            except BaseException as error:  # else the run would wait for a result for ever
                results.put(error)
            del call
