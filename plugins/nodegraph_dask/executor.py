"""The executor ``dask``: many calls at a time, by the workers of a Dask cluster."""

from __future__ import annotations

import threading
import uuid
import weakref
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from distributed import CancelledError, KilledWorker

from nodegraph.executors import (
    Call,
    CallCodec,
    Calls,
    Frame,
    HowToRun,
    Outcome,
    State,
    in_time,
    side_by_side,
)
from nodegraph_dask.cluster import Cluster, cluster_for
from nodegraph_dask.worker import Sent, as_array, as_frame, work

_LARGE_REQUEST = 500_000
"""Bytes from which the buffers of a request are scattered."""
_LARGE_BUFFER = 64_000

_CALLS_PER_THREAD = 3
"""Submitted per thread of the cluster: while one is made, others are on their way."""
_CALLS_HERE = 2
"""Calls at a time that cannot be submitted."""
_MOST_LOSSES = 3
"""Times that a lost call is submitted again."""
_SECONDS_BETWEEN_LOOKS = 1.0
_SECONDS_TO_FETCH = 60.0
"""Seconds in which a response that is ready must arrive."""


def dask(schedule: Calls, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make calls on the cluster at ``how.scheduler``, else on one that is started for the run.

    On a cluster that is already running, there are as many calls at a time as its workers have
    threads. A call whose node or values cannot be sent to another process, or that reads a file,
    is made in this one. Workers may come and go; a call whose worker dies is submitted again.
    """
    with cluster_for(how) as cluster:
        calls = _Calls(schedule, cluster)
        yield from side_by_side(schedule, calls.at_a_time, calls.perform)


class _Calls:
    """Makes calls on a cluster, each in a thread that waits for it."""

    def __init__(self, schedule: Calls, cluster: Cluster) -> None:
        self._schedule = schedule
        self._cluster = cluster
        self._codec = CallCodec(schedule.registry, schedule.packer, local=False)
        self._scattered = Scattered(cluster.client)
        self._suspect = threading.Lock()
        self._here = threading.Semaphore(_CALLS_HERE)
        self._made_here = 0

    def at_a_time(self) -> int:
        """Return how many calls keep all workers busy.

        Raises
        ------
        NodegraphError
            If the cluster is gone, or has had no worker for long.
        """
        self._cluster.count_workers(is_idle=not self._made_here)
        return _CALLS_PER_THREAD * max(self._cluster.threads, 1)

    def perform(self, call: Call) -> Outcome:
        """Make a call on the cluster, or here if it cannot be sent there."""
        request = self._codec.encode(call)
        outcome = "" if request is None else self._made_there(call, request)
        del request
        if not isinstance(outcome, str):
            return self._schedule.keep(call, outcome)
        with self._here:
            self._made_here += 1
            try:
                return in_time(self._schedule.perform, call)
            finally:
                self._made_here -= 1

    def _made_there(self, call: Call, request: Sequence[Frame]) -> Outcome | str:
        """Return the outcome of a call, or why it must be made in this process."""
        try:
            try:
                address, *frames = self._sent(call, request)
            except KilledWorker as error:
                deaths = error.allowed_failures + 1
                # Dask does not know which of the calls that a worker had was the cause of its
                # death: they are made again one by one, so that none fails because of another
                with self._suspect:
                    address, *frames = self._sent(call, request)
        except KilledWorker as error:
            deaths += error.allowed_failures + 1
            reason = f"{deaths} workers that computed it died of it"
        except _Lost:
            reason = f"what computed it was lost {_MOST_LOSSES} times"
        else:
            return self._codec.decode([as_frame(frame) for frame in frames], f"worker {address}")
        return Outcome(State.FAILED, reason=reason)

    def _sent(self, call: Call, request: Sequence[Frame]) -> Sent:
        """Submit a call, again if it is lost with a worker, and return what comes back.

        Raises
        ------
        KilledWorker
            If workers died to which it was assigned, perhaps because of another call.
        _Lost
            If it was lost too often.
        """
        files, address, head, *buffers = request
        for _ in range(_MOST_LOSSES):
            self._cluster.check()
            future = self._cluster.client.submit(
                work,
                call.timeout,
                *(files, address, head),
                *self._scattered.arguments(buffers),
                key=f"{call.node.name}-{uuid.uuid4().hex}",
                pure=False,
            )
            done = threading.Event()
            future.add_done_callback(lambda _, done=done: done.set())
            # Dask does not report all that are lost
            while not done.wait(_SECONDS_BETWEEN_LOOKS) and future.status == "pending":
                pass
            if future.status in ("lost", "cancelled"):
                continue
            try:
                sent: Sent = future.result(timeout=_SECONDS_TO_FETCH)
                return sent
            except (CancelledError, OSError, TimeoutError):
                continue
        raise _Lost


class _Lost(Exception):
    """A call was lost with its workers too often."""


class Scattered:
    """Buffers that the cluster has, by their place in the memory of this process."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._lock = threading.RLock()  # one that is sent by two threads would be sent twice
        self._futures: dict[tuple[int, int], tuple[Any, weakref.ref[Any]]] = {}

    def arguments(self, buffers: Sequence[Frame]) -> list[object]:
        """Return each buffer as an argument of a call: as an array, or as a future of it."""
        arrays = [as_array(buffer) for buffer in buffers]
        if sum(array.nbytes for array in arrays) < _LARGE_REQUEST:
            return list(arrays)
        with self._lock:
            return [
                self._future(array) if array.nbytes >= _LARGE_BUFFER else array for array in arrays
            ]

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
