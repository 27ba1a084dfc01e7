"""Several calls at a time, each in a process of its own on this machine."""

from __future__ import annotations

import threading
from collections.abc import Iterator

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Call, Outcome, timed_out
from nodegraph.execute.executor import HowToRun, Schedule
from nodegraph.execute.threads import Calls, Results, distribute, in_time, make_calls
from nodegraph.execute.worker.client import CallCodec, Worker, WorkerEndedError
from nodegraph.execute.worker.protocol import Request, Response, ResponseKind
from nodegraph.state import State

_MOST_STARTS = 3
"""Of worker processes for one call, of which each ends before it is ready."""


def processes(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make several calls at a time, each in a process of its own.

    A call whose node or values cannot be sent to another process is made in this one. If a
    process dies, the step that it computed fails, and another process takes its place.
    """
    codec = CallCodec(schedule.registry, schedule.packer, shares_files=True, is_new=True)
    slots: list[_Slot] = []
    try:
        yield from distribute(
            schedule,
            how.at_a_time,
            lambda calls, results: slots.append(_Slot(schedule, codec, how.memory, calls, results)),
        )
    except BaseException:
        for slot in slots:
            slot.give_up()
        raise
    finally:
        for slot in slots:
            slot.join()


class _Slot:
    """A thread with a worker process; calls that cannot be sent there are made in the thread."""

    def __init__(
        self,
        schedule: Schedule,
        codec: CallCodec,
        memory: float | None,
        calls: Calls,
        results: Results,
    ) -> None:
        self._schedule = schedule
        self._memory = memory
        self._codec = codec
        self._worker: Worker | None = None
        self._lock = threading.Lock()
        self._given_up = False
        self._is_calling = False
        # a daemon: a node that never returns must not keep the program alive
        self._thread = threading.Thread(target=self._work, args=(calls, results), daemon=True)
        self._thread.start()

    def give_up(self) -> None:
        """End the process at once, whatever it does."""
        with self._lock:
            self._given_up = True
            if self._worker is not None:
                self._worker.kill()

    def join(self) -> None:
        """Wait until the process has ended."""
        if not (self._given_up and self._is_calling):
            self._thread.join()

    def _work(self, calls: Calls, results: Results) -> None:
        make_calls(self._outcome, calls, results)
        if self._worker is not None:
            self._worker.close()

    def _outcome(self, call: Call) -> Outcome:
        if self._given_up:
            raise WorkerEndedError("was given up")
        request = self._codec.encode(call)
        if request is None:
            return self._call_here(call)
        try:
            response = self._send(request, call.timeout)
        except TimeoutError:
            return timed_out(call)
        except WorkerEndedError as error:
            failed = Outcome(State.FAILED, reason=f"the process that computed it {error}")
            return self._schedule.keep(call, failed)
        # a process of this machine lacks a node only if it cannot be imported at all
        is_missing = response.kind is ResponseKind.MISSING
        outcome = None if is_missing else self._codec.decode(response, "a process")
        return self._call_here(call) if outcome is None else self._schedule.keep(call, outcome)

    def _call_here(self, call: Call) -> Outcome:
        self._is_calling = True
        try:
            return in_time(self._schedule.perform, call)
        finally:
            self._is_calling = False

    def _send(self, request: Request, timeout: float | None) -> Response:
        for start in range(1, _MOST_STARTS + 1):
            worker = self._living_worker()
            try:
                return worker.send(request, timeout)
            except WorkerEndedError as error:
                self._worker = None
                worker.close()
                # what ended before it was ready has not begun the call
                if error.was_ready:
                    raise
                if start == _MOST_STARTS:
                    message = f"a worker process does not start: it {error}"
                    raise NodegraphError(message) from error
        raise AssertionError

    def _living_worker(self) -> Worker:
        with self._lock:
            if self._given_up:
                raise WorkerEndedError("was given up")
            if self._worker is not None and not self._worker.is_alive:
                self._worker.close()
                self._worker = None
            if self._worker is None:
                self._worker = Worker(self._memory)
            return self._worker
