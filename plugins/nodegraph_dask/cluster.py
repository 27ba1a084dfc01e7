"""A Dask cluster: one that runs somewhere, or one of our own on this machine."""

from __future__ import annotations

import asyncio
import re
import socket
import subprocess
import tempfile
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from distributed import Client, LocalCluster, Security, rpc

from nodegraph.errors import NodegraphError
from nodegraph.execute.worker import client as client_module
from nodegraph_dask.worker import no_logs

if TYPE_CHECKING:
    from nodegraph.execute.executors.base import HowToRun


_ADDRESS = re.compile(
    r"(?:(?:tcp|tls|wss?|ucxx?)://)?(?P<host>[^\s/:]+|\[[0-9a-f:]+\]):(?P<port>\d+)"
)
_PATIENCE = 3.0
"""Seconds in which a machine must take a connection, and a scheduler must answer."""


def check_scheduler(address: str) -> None:
    """Refuse an address at which no scheduler answers, before a client waits long for it.

    Raises
    ------
    NodegraphError
        If it is no address, or nothing there, or something else.
    """
    parts = _ADDRESS.fullmatch(address)
    if parts is None:
        raise NodegraphError(
            f"{address!r} is not the address of a Dask scheduler; "
            "write it as tcp://127.0.0.1:8786, as the scheduler says when it starts"
        )
    try:
        host, port = parts["host"].strip("[]"), int(parts["port"])
        socket.create_connection((host, port), timeout=_PATIENCE).close()
        # in a thread, because a notebook has a loop of its own in this one
        with ThreadPoolExecutor(1) as thread:
            kind = thread.submit(asyncio.run, _kind(address)).result()
    except (OSError, OverflowError, TimeoutError, ValueError, TypeError, RuntimeError) as error:
        raise _no_answer(address) from error
    if kind != "Scheduler":
        raise _no_answer(address)


async def _kind(address: str) -> str:
    security: Any = Security
    how = security().get_connection_args("client")
    async with asyncio.timeout(_PATIENCE):
        async with rpc(address, connection_args=how) as asked:  # type: ignore[no-untyped-call]
            return str((await asked.identity())["type"])


def _no_answer(address: str) -> NodegraphError:
    return NodegraphError(f"no Dask scheduler answers at {address}; start one with: dask scheduler")


_AT_HAND = 3.0
"""Seconds in which an end must be made of a connection."""


class Cluster:
    """A scheduler that can be asked.

    Attributes
    ----------
    client : distributed.Client
    name : str
        What to call it in messages.
    """

    def __init__(self, client: Any, name: str) -> None:
        self.client = client
        self.name = name

    def threads(self) -> int:
        """Return how many calls can be made at a time now; none while nobody answers."""
        self.check()
        try:
            return sum(self.client.nthreads().values())
        except (OSError, TimeoutError):
            self.check()
            return 0

    def check(self) -> None:
        """Refuse to go on without a scheduler.

        Raises
        ------
        NodegraphError
            If it is gone.
        """
        if self.client.status not in ("running", "connecting"):
            raise NodegraphError(f"{self.name} is gone")

    def look_after(self) -> None:
        """See to it that there are workers, as far as that can be done from here."""


class _OwnCluster(Cluster):
    """A scheduler in this process, with workers on this machine; one that dies is replaced."""

    def __init__(self, client: Any, workers: int) -> None:
        super().__init__(client, "the Dask cluster on this machine")
        self._address: str = client.scheduler.address
        self._folder = tempfile.TemporaryDirectory(prefix="nodegraph-", ignore_cleanup_errors=True)
        self._workers = [self._start() for _ in range(workers)]
        self._started = time.monotonic()

    def look_after(self) -> None:
        if time.monotonic() - self._started < 1.0:
            return  # what ends as soon as it starts is not to be started without end
        for number, worker in enumerate(self._workers):
            if worker.poll() is not None:
                _close(worker)
                self._workers[number] = self._start()
                self._started = time.monotonic()

    def end_workers(self) -> None:
        """End all workers at once, whatever they do."""
        for worker in self._workers:
            client_module.kill(worker)
        for worker in self._workers:
            _close(worker)
        self._folder.cleanup()

    def _start(self) -> subprocess.Popen[bytes]:
        program = "nodegraph_dask.worker"
        return client_module.start(program, self._address, self._folder.name)


def _close(worker: subprocess.Popen[bytes]) -> None:
    worker.wait()
    if worker.stdin is not None:
        worker.stdin.close()


@contextmanager
def cluster_for(how: HowToRun) -> Iterator[Cluster]:
    """Connect to the scheduler that is named, or to one that lives as long as the run.

    Raises
    ------
    NodegraphError
        If nothing answers at the address, or it is none.
    """
    with no_logs():
        if how.scheduler:
            with _client(how.scheduler) as client:
                yield Cluster(client, f"the Dask cluster at {how.scheduler}")
        else:
            with _own(how.at_a_time) as cluster:
                yield cluster


@contextmanager
def _client(address: str) -> Iterator[Any]:
    check_scheduler(address)
    with warnings.catch_warnings():
        # of versions that differ, the answers tell what matters
        warnings.simplefilter("ignore")
        client = Client(address, set_as_default=False)  # type: ignore[no-untyped-call]
    try:
        yield client
    finally:
        client.close(timeout=_AT_HAND)  # type: ignore[no-untyped-call]


@contextmanager
def _own(workers: int) -> Iterator[Cluster]:
    scheduler = LocalCluster(  # type: ignore[no-untyped-call]
        n_workers=0,
        host="127.0.0.1",
        dashboard_address="127.0.0.1:0",
        # calls whose worker died are tried again one by one
        scheduler_kwargs={"allowed_failures": 0},
    )
    try:
        with Client(  # type: ignore[no-untyped-call]
            scheduler, set_as_default=False, direct_to_workers=True
        ) as client:
            cluster = _OwnCluster(client, workers)
            try:
                yield cluster
            finally:
                cluster.end_workers()
    finally:
        scheduler.close(timeout=_AT_HAND)


LOOK = 0.5
"""Seconds between two looks."""
WAIT = 30.0
"""Seconds without any worker after which a run gives up."""


class Crew:
    """Counts the workers, and waits for new ones when all are gone.

    Attributes
    ----------
    threads : int
        Calls that they made at a time when they were last counted.
    """

    def __init__(self, cluster: Cluster) -> None:
        self._cluster = cluster
        self._looked = self._seen = time.monotonic()
        self._told = False
        self.threads = cluster.threads()

    def look(self, *, may_give_up: bool) -> bool:
        """Count the workers again, if that is due; return whether it was.

        Raises
        ------
        NodegraphError
            If none has been there for long.
        """
        if time.monotonic() - self._looked < LOOK:
            return False
        self._cluster.look_after()
        self.threads = self._cluster.threads()
        self._looked = time.monotonic()
        if self.threads:
            self._seen = self._looked
        else:
            self._wait(may_give_up)
        return True

    def _wait(self, may_give_up: bool) -> None:
        alone = time.monotonic() - self._seen
        if alone > WAIT and may_give_up:
            raise NodegraphError(f"{self._cluster.name} has had no worker for {WAIT:g} seconds")
        if alone > WAIT / 6 and not self._told:
            self._told = True
            warnings.warn(
                f"{self._cluster.name} has no worker; waiting {WAIT:g} seconds for one",
                stacklevel=2,
            )
