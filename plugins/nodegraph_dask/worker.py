"""The program of a worker of a Dask cluster, on this machine or another, and its calls."""

from __future__ import annotations

import asyncio
import json
import logging
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any

import dask
import numpy as np
from distributed import Security, Worker, get_worker
from numpy.typing import NDArray

from nodegraph.executors import Frame, respond, unwatch_random

CERTIFICATES = "certificates.json"
"""File in the folder of a worker, with what it needs to connect to the scheduler."""

Sent = tuple[object, ...]
"""The worker's address, then the frames of the response; large ones as arrays of bytes."""


def work(timeout: float | None, *frames: object) -> Sent:
    """Return the response to a request; both are given as frames."""
    unwatch_random()  # its own threads draw from it
    text, head, *buffers = respond([as_frame(frame) for frame in frames], timeout)
    return get_worker().address, text, head, *map(as_array, buffers)


def as_array(buffer: Frame) -> NDArray[np.uint8]:
    """Return a buffer as an array of bytes, which Dask sends without a copy."""
    return np.frombuffer(buffer, np.uint8) if len(buffer) else np.empty(0, np.uint8)


def as_frame(value: Any) -> Frame:
    """Return the buffer of which `as_array` returned an array."""
    return value.data.toreadonly() if isinstance(value, np.ndarray) else bytes(value)


@contextmanager
def no_logs() -> Iterator[None]:
    """Have Dask log nothing: the run itself reports what its user must know, once."""
    names = [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]
    loggers = [logging.getLogger(name) for name in ("distributed", *names)]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def no_pages() -> AbstractContextManager[object]:
    """Have schedulers and workers of Dask serve no pages, which every user of the machine may read.

    They tell of calls and logs; calls themselves need a certificate.
    """
    places = ("distributed.scheduler.http.routes", "distributed.worker.http.routes")
    return dask.config.set({place: [] for place in places})


def main() -> None:
    """Work for the scheduler at the address in ``sys.argv[1]`` until the standard input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)  # what a node prints is not output of the program
    threading.Thread(target=_end_with_input, daemon=True).start()
    with no_logs(), no_pages():
        asyncio.run(_serve(*sys.argv[1:]))


async def _serve(scheduler: str, folder: str) -> None:
    certificates = json.loads(Path(folder, CERTIFICATES).read_text())
    worker = Worker(
        scheduler,
        nthreads=1,
        host="127.0.0.1",
        local_directory=folder,
        security=Security(require_encryption=True, **certificates),  # type: ignore[no-untyped-call]
        dashboard_address="127.0.0.1:0",
        dashboard=False,
        # without a limit, it neither pauses nor writes values to disk
        memory_limit=0,
    )
    async with worker:
        await worker.finished()  # type: ignore[no-untyped-call]


def _end_with_input() -> None:
    while os.read(0, 1024):
        pass
    os._exit(0)
