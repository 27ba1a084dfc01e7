"""The executor ``dask``: many calls at a time, by the workers of a Dask cluster."""

from __future__ import annotations

import threading
import uuid
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any, Generic, TypeVar

import numpy as np
from distributed import CancelledError, KilledWorker

from nodegraph.executors import (
    Call,
    CallCodec,
    Frame,
    HowToRun,
    Outcome,
    Response,
    Schedule,
    State,
    in_time,
    one_thread_here,
)
from nodegraph_dask.cluster import SECONDS_BETWEEN_COUNTS, Cluster, cluster_for
from nodegraph_dask.worker import Sent, as_array, as_frame, work

_LARGE_REQUEST = 500_000
"""Bytes from which the buffers of a request are scattered."""
_LARGE_BUFFER = 64_000

_CALLS_PER_THREAD = 3
"""Submitted per thread of the cluster: while one is made, others are on their way."""
_MOST_LOSSES = 3
"""How often a call is submitted again that was lost."""
_SECONDS_TO_FETCH = 60.0
"""In which a response must arrive that is ready."""

T = TypeVar("T")


def dask(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make calls on the cluster at ``how.scheduler``, else on one that is started for the run.

    On a cluster that is already running, there are as many calls at a time as its workers have
    threads. A call whose node or values cannot be sent to another process, or that reads a file,
    is made in this one. Workers may come and go; a call whose worker dies is submitted again.
    """
    call = schedule.next()
    if call is None:
        return  # no cluster is started for nothing
    with cluster_for(how) as cluster:
        submissions = _Submissions(schedule, cluster)
        try:
            submissions.submit(call)
            del call
            submissions.submit_all()
            while submissions.running:
                yield submissions.next()
                submissions.submit_all()
        finally:
            submissions.close()


@dataclass
class _Submission:
    """A call that was submitted to the cluster.

    Attributes
    ----------
    call : Call
    key : str
    future : Any
        Of the response.
    losses : int
        How often the request or the response was lost with a worker.
    deaths : int
        How many workers have died to which it was assigned, perhaps because of another call.
    """

    call: Call
    key: str = ""
    future: Any = None
    losses: int = 0
    deaths: int = 0


class _Submissions:
    """The calls of a run on a cluster.

    The thread of the run submits calls and takes results. Dask's thread reports futures that are
    done; a thread fetches their responses, because large ones take time; two threads make the
    calls that cannot be submitted. All of them report to the run's thread through one queue:
    the key of a future that is done, a submission to be made again, or a result.

    Attributes
    ----------
    running : int
        Calls without a result.
    """

    def __init__(self, schedule: Schedule, cluster: Cluster) -> None:
        self.running = 0
        self._schedule = schedule
        self._cluster = cluster
        registry, packer = schedule.registry, schedule.packer
        self._codec = CallCodec(registry, packer, shares_files=False, is_new=False)
        self._scattered = Scattered(cluster.client)
        self._by_key: dict[str, _Submission] = {}
        self._suspects: deque[_Submission] = deque()
        self._suspect = ""
        self._reports: SimpleQueue[str | _Submission | tuple[int, Outcome] | BaseException]
        self._reports = SimpleQueue()
        self._local = _Threads(2, self._call_here, self._reports.put)
        self._fetching = _Threads(1, self._fetch, self._reports.put)

    def submit_all(self) -> None:
        """Submit as many calls as keep all workers busy."""
        while self.running < _CALLS_PER_THREAD * max(self._cluster.threads, 1):
            call = self._schedule.next()
            if call is None:
                return
            self.submit(call)

    def submit(self, call: Call) -> None:
        """Submit a call."""
        self.running += 1
        self._submit(_Submission(call))

    def next(self) -> tuple[int, Outcome]:
        """Wait for the next result."""
        while True:
            try:
                report = self._reports.get(timeout=SECONDS_BETWEEN_COUNTS)
            except Empty:
                report = None
            if isinstance(report, BaseException):
                raise report
            if isinstance(report, tuple):
                self.running -= 1
                return report
            if isinstance(report, _Submission):
                self._submit_again(report)
            elif report is not None:
                self._take_done(report)
            if self._cluster.count_workers(is_idle=self._reports.empty()):
                for key in list(self._by_key):  # Dask does not report all that are lost
                    self._take_done(key)
            if self._suspects and self._suspect not in self._by_key:
                suspect = self._suspects.popleft()
                self._submit(suspect)
                self._suspect = suspect.key

    def close(self) -> None:
        """Give up the calls that are still running."""
        self._local.close()
        self._fetching.close()
        self._by_key.clear()

    def _submit(self, submission: _Submission) -> None:
        self._cluster.check()
        request = self._codec.encode(submission.call)
        if request is None:
            self._local.put(submission.call)
            return
        texts = (request.environment, request.address, request.head)
        buffers = self._scattered.arguments(request.buffers)
        submission.key = f"{submission.call.node.name}-{uuid.uuid4().hex}"
        submission.future = self._cluster.client.submit(
            work, submission.call.timeout, *texts, *buffers, key=submission.key, pure=False
        )
        self._by_key[submission.key] = submission
        submission.future.add_done_callback(lambda future: self._reports.put(future.key))

    def _submit_again(self, submission: _Submission) -> None:
        """Submit a call again that was lost, or whose worker died.

        If a worker dies, Dask does not know which of the calls that it had was the cause. All are
        suspects, and submitted one by one, so that none fails because of another.
        """
        if submission.deaths:
            self._suspects.append(submission)
        elif submission.losses < _MOST_LOSSES:
            self._submit(submission)
        else:
            self._fail(submission.call, f"what computed it was lost {_MOST_LOSSES} times")

    def _take_done(self, key: str) -> None:
        submission = self._by_key.get(key)
        if submission is None or submission.future.status == "pending":
            return
        del self._by_key[key]
        if submission.future.status in ("lost", "cancelled"):
            submission.losses += 1
            self._submit_again(submission)
        else:
            self._fetching.put(submission)

    def _fetch(self, submission: _Submission) -> None:
        call = submission.call
        try:
            sent: Sent = submission.future.result(timeout=_SECONDS_TO_FETCH)
        except (CancelledError, OSError, TimeoutError):
            submission.losses += 1
            self._reports.put(submission)
        except KilledWorker as error:
            was_suspect = bool(submission.deaths)
            submission.deaths += error.allowed_failures + 1
            if was_suspect:
                self._fail(call, f"{submission.deaths} workers that computed it died of it")
            else:
                self._reports.put(submission)
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
            self._fail(call, f"{self._cluster.name} could not compute it: {reason}")
        else:
            address, *frames = sent
            response = Response.from_frames([as_frame(frame) for frame in frames])
            outcome = self._codec.decode(response, f"worker {address}")
            if outcome is None:
                self._local.put(call)
            else:
                self._reports.put((call.step, self._schedule.keep(call, outcome)))

    def _fail(self, call: Call, reason: str) -> None:
        outcome = Outcome(State.FAILED, reason=reason)
        self._reports.put((call.step, self._schedule.keep(call, outcome)))

    def _call_here(self, call: Call) -> None:
        with one_thread_here():
            self._reports.put((call.step, in_time(self._schedule.perform, call)))


class _Threads(Generic[T]):
    """Threads that call a function with each item of a queue.

    Parameters
    ----------
    count
        They are daemons: a node that never returns must not keep the program alive.
    function
    report
        Called with what the function raises.
    """

    def __init__(
        self, count: int, function: Callable[[T], None], report: Callable[[BaseException], None]
    ) -> None:
        self._count = count
        self._function = function
        self._report = report
        self._items: SimpleQueue[T | None] = SimpleQueue()
        for _ in range(count):
            threading.Thread(target=self._work, daemon=True).start()

    def put(self, item: T) -> None:
        """Add an item to the queue."""
        self._items.put(item)

    def close(self) -> None:
        """Let the threads end after the items that are in the queue."""
        for _ in range(self._count):
            self._items.put(None)

    def _work(self) -> None:
        while (item := self._items.get()) is not None:
            try:
                self._function(item)
            except BaseException as error:  # else the run would wait for a report for ever
                self._report(error)
            del item


class Scattered:
    """Buffers that the cluster has, by their place in the memory of this process."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._futures: dict[tuple[int, int], tuple[Any, weakref.ref[Any]]] = {}

    def arguments(self, buffers: Sequence[Frame]) -> list[object]:
        """Return each buffer as an argument of a call: as an array, or as a future of it."""
        arrays = [as_array(buffer) for buffer in buffers]
        if sum(array.nbytes for array in arrays) < _LARGE_REQUEST:
            return list(arrays)
        return [self._future(array) if array.nbytes >= _LARGE_BUFFER else array for array in arrays]

    def _future(self, array: Any) -> object:
        place = (array.ctypes.data, array.nbytes)
        known = self._futures.get(place)
        if known is not None and known[1]() is not None and known[0].status == "finished":
            return known[0]
        try:
            future = self._client.scatter([array], hash=False, timeout=5)[0]
        except TimeoutError:  # no worker can take it now
            return array
        owner = weakref.ref(_owner(array), lambda _: self._futures.pop(place, None))
        self._futures[place] = (future, owner)
        return future


def _owner(array: Any) -> object:
    """Return the array that lives as long as the memory is in use."""
    while isinstance(getattr(array.base, "obj", array.base), np.ndarray):
        array = getattr(array.base, "obj", array.base)
    return array
