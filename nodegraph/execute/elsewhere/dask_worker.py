"""The program of a worker of a cluster on this machine."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading

from distributed import Worker

from nodegraph.execute.elsewhere.quiet import no_logs


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
