"""Many calls at a time, on a Dask cluster: one that runs somewhere, or one on this machine."""

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

from nodegraph.execute.call import Call, Outcome
from nodegraph.execute.executors.base import HowToRun
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.worker.client import Asker
from nodegraph.execute.worker.protocol import Answer, Frame
from nodegraph.state import State
from nodegraph_dask.cluster import LOOK, Cluster, Crew, cluster_for
from nodegraph_dask.worker import Sent, as_bytes_array, as_frame, work

_LARGE = 500_000
_SMALL = 64_000


class SentOnce:
    """Buffers that the cluster has, by where they lie here."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._sent: dict[tuple[int, int], tuple[Any, weakref.ref[Any]]] = {}

    def arguments(self, buffers: Sequence[Frame]) -> list[Any]:
        """Return each buffer as what goes along with a call: itself, or a future of it."""
        arrays = [as_bytes_array(one) for one in buffers]
        if sum(one.nbytes for one in arrays) < _LARGE:
            return list(arrays)
        return [self._future(one) if one.nbytes >= _SMALL else one for one in arrays]

    def _future(self, array: Any) -> Any:
        at = (array.ctypes.data, array.nbytes)
        known = self._sent.get(at)
        if known is not None and known[1]() is not None and known[0].status == "finished":
            return known[0]
        try:
            future = self._client.scatter([array], hash=False, timeout=5)[0]
        except TimeoutError:  # no worker is there to take it: the scheduler does
            return array
        owner = weakref.ref(_owner(array), lambda _: self._sent.pop(at, None))
        self._sent[at] = (future, owner)
        return future


def _owner(array: Any) -> Any:
    """Return the array that lives as long as the memory is in use."""
    while isinstance(getattr(array.base, "obj", array.base), np.ndarray):
        array = getattr(array.base, "obj", array.base)
    return array


T = TypeVar("T")


class Helper(Generic[T]):
    """Threads that do something with each thing that they are given.

    Parameters
    ----------
    do
        What to do.
    failed
        Told what `do` raises.
    threads
        How many at a time. They are daemons, because a node that never returns must not keep an
        interrupted program alive.
    """

    def __init__(
        self, do: Callable[[T], None], failed: Callable[[BaseException], None], threads: int = 1
    ) -> None:
        self._do = do
        self._failed = failed
        self._things: SimpleQueue[T | None] = SimpleQueue()
        self._threads = threads
        for _ in range(threads):
            threading.Thread(target=self._work, daemon=True).start()

    def give(self, thing: T) -> None:
        """Have something done."""
        self._things.put(thing)

    def close(self) -> None:
        """Let the threads end, once they have done what they do."""
        for _ in range(self._threads):
            self._things.put(None)

    def _work(self) -> None:
        while (thing := self._things.get()) is not None:
            try:
                self._do(thing)
            except BaseException as error:  # else whoever waits for it waits for ever
                self._failed(error)
            del thing


_AHEAD = 3
"""Calls on their way per thread of the cluster: one is made while others come and go."""
_TRIES = 3
_FETCH = 60.0
"""Seconds in which an answer must arrive that is there."""


@dataclass
class _Flight:
    """A call on its way.

    Attributes
    ----------
    call : Call
    key : str
    future : Any
        The answer.
    losses : int
        How often what was sent, or the answer, has been lost with a worker.
    deaths : int
        How many workers have died that were to compute it, though perhaps of another call.
    """

    call: Call
    key: str = ""
    future: Any = None
    losses: int = 0
    deaths: int = 0


def outcomes_of(schedule: Schedule, first: Call, cluster: Cluster) -> Iterator[tuple[int, Outcome]]:
    """Yield (step, outcome) for a first call, and for all others that a schedule hands out."""
    traffic = _Traffic(schedule, cluster)
    try:
        traffic.send(first)
        del first
        traffic.send_all()
        while traffic.running:
            yield traffic.next()
            traffic.send_all()
    finally:
        traffic.close()


class _Traffic:
    """What is on its way, and what has come back."""

    def __init__(self, schedule: Schedule, cluster: Cluster) -> None:
        self._schedule = schedule
        self._cluster = cluster
        self._asker = Asker(schedule, shares_files=False, are_new=False)
        self._sent_once = SentOnce(cluster.client)
        self._crew = Crew(cluster)
        self._back: SimpleQueue[str | _Flight | tuple[int, Outcome] | BaseException] = SimpleQueue()
        self._here = Helper(self._make_here, self._back.put, threads=2)
        self._receiver = Helper(self._receive, self._back.put)
        self._flights: dict[str, _Flight] = {}
        self._suspects: deque[_Flight] = deque()
        self._suspect = ""
        self.running = 0

    def send_all(self) -> None:
        """Send calls, as many as keep all workers busy and no more."""
        while self.running < _AHEAD * max(self._crew.threads, 1):
            call = self._schedule.next()
            if call is None:
                return
            self.send(call)

    def send(self, call: Call) -> None:
        """Send a call."""
        self.running += 1
        self._send(_Flight(call))

    def next(self) -> tuple[int, Outcome]:
        """Wait for the next outcome."""
        while True:
            try:
                found = self._back.get(timeout=LOOK)
            except Empty:
                found = None
            if isinstance(found, BaseException):
                raise found
            if isinstance(found, tuple):
                self.running -= 1
                return found
            if isinstance(found, _Flight):
                self._send_again(found)
            elif found is not None:
                self._land(found)
            self._look_after_all()

    def close(self) -> None:
        """Give up what is still on its way."""
        self._here.close()
        self._receiver.close()
        self._flights.clear()

    def _look_after_all(self) -> None:
        if self._crew.look(may_give_up=self._back.empty()):
            for key in list(self._flights):  # of some that are lost nobody tells
                self._land(key)
        if self._suspects and self._suspect not in self._flights:
            suspect = self._suspects.popleft()
            self._send(suspect)
            self._suspect = suspect.key

    def _send(self, flight: _Flight) -> None:
        self._cluster.check()
        question = self._asker.question(flight.call)
        if question is None:
            self._here.give(flight.call)
            return
        surroundings, address, head, *_ = question.frames()
        buffers = self._sent_once.arguments(question.buffers)
        flight.key = f"{flight.call.node.name}-{uuid.uuid4().hex}"
        flight.future = self._cluster.client.submit(
            work, surroundings, address, head, *buffers, key=flight.key, pure=False
        )
        self._flights[flight.key] = flight
        flight.future.add_done_callback(lambda done: self._back.put(done.key))

    def _send_again(self, flight: _Flight) -> None:
        """Send a call again whose answer was lost, or whose worker died.

        If a worker dies, Dask cannot tell which of the calls that it had was the cause. They are
        suspects, sent one after the other, so that the others do not fail together with it.
        """
        if flight.deaths:
            self._suspects.append(flight)
        elif flight.losses < _TRIES:
            self._send(flight)
        else:
            self._fail(flight.call, f"what computed it was lost {_TRIES} times")

    def _land(self, key: str) -> None:
        """Hand on a flight that has ended."""
        flight = self._flights.get(key)
        if flight is None or flight.future.status == "pending":
            return
        del self._flights[key]
        if flight.future.status in ("lost", "cancelled"):
            flight.losses += 1
            self._send_again(flight)
        else:
            self._receiver.give(flight)

    def _receive(self, flight: _Flight) -> None:
        """Fetch an answer; in a thread of its own, because a large one takes its time."""
        try:
            sent: Sent = flight.future.result(timeout=_FETCH)
        except (CancelledError, OSError, TimeoutError):
            flight.losses += 1
            self._back.put(flight)
        except KilledWorker as error:
            self._suspect_or_fail(flight, error.allowed_failures + 1)
        except Exception as error:
            said = f"{type(error).__name__}: {error}"
            self._fail(flight.call, f"{self._cluster.name} could not compute it: {said}")
        else:
            self._take(flight.call, sent)

    def _suspect_or_fail(self, flight: _Flight, deaths: int) -> None:
        was_suspect = bool(flight.deaths)
        flight.deaths += deaths
        if was_suspect:
            self._fail(flight.call, f"{flight.deaths} workers that computed it died of it")
        else:
            self._back.put(flight)

    def _take(self, call: Call, sent: Sent) -> None:
        who, *frames = sent
        answer = Answer.from_frames([as_frame(one) for one in frames])
        outcome = self._asker.outcome(answer, f"worker {who}")
        if outcome is None:
            self._here.give(call)
        else:
            self._back.put((call.step, self._schedule.keep(call, outcome)))

    def _fail(self, call: Call, reason: str) -> None:
        outcome = Outcome(State.FAILED, reason=reason)
        self._back.put((call.step, self._schedule.keep(call, outcome)))

    def _make_here(self, call: Call) -> None:
        self._back.put((call.step, self._schedule.perform(call)))


def dask(schedule: Schedule, how: HowToRun) -> Iterator[tuple[int, Outcome]]:
    """Make calls on the cluster at ``how.scheduler``, else on one that is started for the run.

    On a cluster that others have started, calls are as many as its workers have threads. A call
    whose node or values cannot go to another process, or that reads a file, is made here. Workers
    may come and go; a call whose worker dies is made again by another one.
    """
    first = schedule.next()
    if first is None:
        return  # for nothing, no cluster is started
    with cluster_for(how) as cluster:
        yield from outcomes_of(schedule, first, cluster)
