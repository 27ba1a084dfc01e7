"""The program of a worker of a cluster on this machine."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from distributed import Worker, get_worker

from nodegraph.execute.numeric_threads import one_thread_here
from nodegraph.execute.worker.protocol import Frame, Question
from nodegraph.execute.worker.server import answer

Sent = tuple[Any, ...]
"""The worker's address, then the frames of the answer; large ones as arrays of bytes."""


def work(*frames: Any) -> Sent:
    """Answer a question, given as its frames."""
    question = Question.from_frames([as_frame(one) for one in frames])
    with one_thread_here():
        said, head, *buffers = answer(question).frames()
    return get_worker().address, said, head, *map(as_bytes_array, buffers)


def as_bytes_array(buffer: Frame) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return bytes as what Dask sends as they lie."""
    return np.frombuffer(buffer, np.uint8) if len(buffer) else np.empty(0, np.uint8)


def as_frame(sent: Any) -> Frame:
    """Return what `as_bytes_array` made an array of."""
    return sent.data.toreadonly() if isinstance(sent, np.ndarray) else bytes(sent)


_NONE = logging.CRITICAL + 1


@contextmanager
def no_logs() -> Iterator[None]:
    """Let Dask log nothing: what a user must know is said by this program, once."""
    names = [one for one in logging.root.manager.loggerDict if one.startswith("distributed")]
    loggers = [logging.getLogger(one) for one in ("distributed", *names)]
    levels = [one.level for one in loggers]
    for one in loggers:
        one.setLevel(_NONE)
    try:
        yield
    finally:
        for one, level in zip(loggers, levels, strict=True):
            one.setLevel(level)


def main() -> None:
    """Compute until the standard input ends, for the scheduler of ``sys.argv[1]``."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.dup2(2, 1)  # what a node prints is none of the program's results
    threading.Thread(target=_end_with_input, daemon=True).start()
    with no_logs():
        asyncio.run(_serve(*sys.argv[1:]))


async def _serve(scheduler: str, folder: str) -> None:
    worker = Worker(
        scheduler,
        nthreads=1,
        host="127.0.0.1",
        local_directory=folder,
        dashboard_address="127.0.0.1:0",
        dashboard=False,
        # a worker that is paused, or writes values to disk, would help nobody here
        memory_limit=0,
    )
    async with worker:
        await worker.finished()  # type: ignore[no-untyped-call]


def _end_with_input() -> None:
    while os.read(0, 1024):
        pass
    os._exit(0)
