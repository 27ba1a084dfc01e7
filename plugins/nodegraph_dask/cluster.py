"""A Dask cluster: one that is already running, or one of the run's own on this machine."""

from __future__ import annotations

import asyncio
import json
import re
import socket
import subprocess
import tempfile
import time
import warnings
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from distributed import Client, LocalCluster, Security, rpc

from nodegraph import NodegraphError
from nodegraph.executors import HowToRun, kill, start
from nodegraph_dask.worker import CERTIFICATES, no_logs, no_pages

_SECONDS_BETWEEN_COUNTS = 0.5
SECONDS_WITHOUT_WORKERS = 30.0
"""After which a run gives up."""
_SECONDS_TO_ANSWER = 3.0
"""Seconds in which a machine must accept a connection, and a scheduler must answer."""
_SECONDS_TO_RECONNECT = 10.0
"""Seconds after which a scheduler is gone whose connection was lost; a busy one keeps its own."""
_SECONDS_TO_CLOSE = 3.0

_ADDRESS = re.compile(
    r"(?:(?:tcp|tls|wss?|ucxx?)://)?(?P<host>[^\s/:]+|\[[0-9a-f:]+\]):(?P<port>\d+)"
)


@contextmanager
def cluster_for(how: HowToRun) -> Iterator[Cluster]:
    """Connect to the scheduler that is named, or to one that lives as long as the run.

    Raises
    ------
    NodegraphError
        If the address is not valid, or no scheduler answers there.
    """
    with no_logs():
        if how.scheduler:
            _check_scheduler(how.scheduler)
            with _client(how.scheduler) as client:
                yield Cluster(client, f"the Dask cluster at {how.scheduler}")
        else:
            with _own_cluster(how.at_a_time) as cluster:
                yield cluster


class Cluster:
    """A connection to a scheduler.

    Attributes
    ----------
    client : distributed.Client
    name : str
        The name of the cluster, in messages.
    threads : int
        Threads of all workers, when they were last counted.
    """

    def __init__(self, client: Any, name: str) -> None:
        self.client = client
        self.name = name
        self.threads = self._count_threads()
        self._counted = self._seen = time.monotonic()
        self._has_warned = False

    def check(self) -> None:
        """Raise an error if the scheduler is gone.

        Raises
        ------
        NodegraphError
        """
        if self.client.status not in ("running", "connecting"):
            raise NodegraphError(f"{self.name} is gone")

    def count_workers(self, *, is_idle: bool) -> None:
        """Count the workers again, if that is due.

        Parameters
        ----------
        is_idle
            Whether nothing else can be done without a worker.

        Raises
        ------
        NodegraphError
            If there has been none for long.
        """
        if time.monotonic() - self._counted < _SECONDS_BETWEEN_COUNTS:
            return
        self.replace_workers()
        self.threads = self._count_threads()
        self._counted = time.monotonic()
        if self.threads:
            self._seen = self._counted
            return
        seconds, most = self._counted - self._seen, SECONDS_WITHOUT_WORKERS
        if seconds > most and is_idle:
            if self.client.status != "running":
                raise NodegraphError(f"{self.name} is gone")
            raise NodegraphError(f"{self.name} has had no worker for {most:g} seconds")
        if seconds > most / 6 and not self._has_warned:
            self._has_warned = True
            warnings.warn(
                f"{self.name} has no worker; waiting {most:g} seconds for one", stacklevel=2
            )

    def replace_workers(self) -> None:
        """Replace workers that have died, where they belong to this run."""

    def _count_threads(self) -> int:
        """Return how many calls can be made at a time; none while no worker answers."""
        self.check()
        try:
            return sum(self.client.nthreads().values())
        except (OSError, TimeoutError):
            self.check()
            return 0


class _OwnCluster(Cluster):
    """A scheduler in this process, with workers on this machine; a worker that dies is replaced.

    Whoever reaches a scheduler can run code as its user: connections need a certificate that only
    this process and its workers have.
    """

    def __init__(self, client: Any, workers: int, certificates: dict[str, str]) -> None:
        super().__init__(client, "the Dask cluster on this machine")
        self._address: str = client.scheduler.address
        self._folder = tempfile.TemporaryDirectory(prefix="nodegraph-", ignore_cleanup_errors=True)
        # the folder, and so the file, can be read by this user alone
        Path(self._folder.name, CERTIFICATES).write_text(json.dumps(certificates))
        self._workers = [self._start() for _ in range(workers)]
        self._started = time.monotonic()

    def replace_workers(self) -> None:
        if time.monotonic() - self._started < 1.0:
            return  # workers that end as soon as they start would be started without end
        for number, worker in enumerate(self._workers):
            if worker.poll() is not None:
                _close(worker)
                self._workers[number] = self._start()
                self._started = time.monotonic()

    def end_workers(self) -> None:
        """End all workers at once, whatever they do."""
        for worker in self._workers:
            kill(worker)
        for worker in self._workers:
            _close(worker)
        self._folder.cleanup()

    def _start(self) -> subprocess.Popen[bytes]:
        return start("nodegraph_dask.worker", self._address, self._folder.name)


def _close(worker: subprocess.Popen[bytes]) -> None:
    worker.wait()
    if worker.stdin is not None:
        worker.stdin.close()


@contextmanager
def _own_cluster(workers: int) -> Iterator[Cluster]:
    security: Any = Security.temporary()  # type: ignore[no-untyped-call]
    certificates = {
        "tls_ca_file": security.tls_ca_file,
        "tls_worker_cert": security.tls_worker_cert,
        "tls_worker_key": security.tls_worker_key,
    }
    with no_pages():
        scheduler = LocalCluster(  # type: ignore[no-untyped-call]
            n_workers=0,
            host="127.0.0.1",
            security=security,
            # calls whose worker has died are tried again one by one
            scheduler_kwargs={
                "allowed_failures": 0,
                "dashboard": False,
                "dashboard_address": "127.0.0.1:0",
            },
        )
    try:
        with Client(  # type: ignore[no-untyped-call]
            scheduler, set_as_default=False, direct_to_workers=True
        ) as client:
            # for so long, a result is asked of a worker that has died, and no other arrives
            client.rpc.timeout = _SECONDS_TO_ANSWER
            cluster = _OwnCluster(client, workers, certificates)
            try:
                yield cluster
            finally:
                cluster.end_workers()
    finally:
        scheduler.close(timeout=_SECONDS_TO_CLOSE)


@contextmanager
def _client(address: str) -> Iterator[object]:
    with warnings.catch_warnings():
        # responses report the differences of versions that matter
        warnings.simplefilter("ignore")
        client = Client(  # type: ignore[no-untyped-call]
            address, set_as_default=False, timeout=_SECONDS_TO_RECONNECT
        )
    try:
        yield client
    finally:
        client.close(timeout=_SECONDS_TO_CLOSE)  # type: ignore[no-untyped-call]


def _check_scheduler(address: str) -> None:
    """Raise an error unless a scheduler answers, for which a client would wait long."""
    parts = _ADDRESS.fullmatch(address)
    if parts is None:
        raise NodegraphError(
            f"{address!r} is not the address of a Dask scheduler; "
            "write it as tcp://127.0.0.1:8786, as the scheduler prints it when it starts"
        )
    try:
        host, port = parts["host"].strip("[]"), int(parts["port"])
        socket.create_connection((host, port), timeout=_SECONDS_TO_ANSWER).close()
        # in a thread, because a notebook has an event loop in this one
        with ThreadPoolExecutor(1) as thread:
            kind = thread.submit(asyncio.run, _kind(address)).result()
    except (OSError, OverflowError, TimeoutError, ValueError, TypeError, RuntimeError) as error:
        raise _no_answer(address) from error
    if kind != "Scheduler":
        raise _no_answer(address)


async def _kind(address: str) -> str:
    """Return what kind of Dask server answers at an address."""
    security: Any = Security
    arguments = security().get_connection_args("client")
    async with asyncio.timeout(_SECONDS_TO_ANSWER):
        async with rpc(address, connection_args=arguments) as server:  # type: ignore[no-untyped-call]
            return str((await server.identity())["type"])


def _no_answer(address: str) -> NodegraphError:
    return NodegraphError(f"no Dask scheduler answers at {address}; start one with: dask scheduler")
