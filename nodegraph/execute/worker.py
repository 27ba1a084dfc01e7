"""The program of a worker process, which makes calls one after the other."""

from __future__ import annotations

import json
import multiprocessing.connection
import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph.execute.messages import Frame, plugins_of, respond
from nodegraph.execute.numeric_threads import one_thread_each

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

_PIECE = 1 << 16
"""Bytes that are sent at a time: 50 MB at once take three times as long, mostly to be allocated."""


def send(connection: Connection, message: Sequence[Frame]) -> None:
    """Send a list of buffers, of which none is copied."""
    connection.send_bytes(json.dumps([len(frame) for frame in message]).encode())
    for frame in message:
        for start in range(0, len(frame), _PIECE):
            connection.send_bytes(frame, start, min(_PIECE, len(frame) - start))


def receive(connection: Connection) -> list[Frame]:
    """Receive a list of buffers.

    Raises
    ------
    EOFError, OSError
        If the process at the other end has ended.
    """
    message: list[Frame] = []
    for size in json.loads(connection.recv_bytes()):
        buffer = np.empty(size, np.uint8).data
        count = 0
        while count < size:
            count += connection.recv_bytes_into(buffer, count)
        message.append(buffer.toreadonly())
    return message


def main() -> None:
    """Respond to the requests that come through the connection ``sys.argv[1]``."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    number, *limit = sys.argv[1:]
    limited_memory = partial(_limited_memory, float(limit[0])) if limit else nullcontext
    connection = _connection(int(number))
    threading.Thread(target=_end_with_parent, args=[os.dup(0)], daemon=True).start()
    null = os.open(os.devnull, os.O_RDONLY)
    os.dup2(null, 0)
    os.dup2(2, 1)  # what a node prints is not output of the program
    is_ready = False
    with one_thread_each(), suppress(EOFError, OSError):  # also of libraries that plugins load
        while True:
            request = receive(connection)
            if not is_ready:
                # plugins are loaded before the time of the first call begins
                with suppress(Exception):  # to be reported in response to the call
                    plugins_of(request)
                connection.send_bytes(b"ready")
                is_ready = True
            with limited_memory():
                response = respond(request)
            send(connection, response)
            del request, response


def _connection(number: int) -> Connection:
    if sys.platform == "win32":
        os.set_handle_inheritable(number, False)
        return multiprocessing.connection.PipeConnection(number)
    os.set_inheritable(number, False)  # else a process that a node leaves would keep it open
    return multiprocessing.connection.Connection(number)


def _end_with_parent(pipe: int) -> None:
    """End this process, in the middle of a call, when the other end of a pipe is closed."""
    while os.read(pipe, 1024):
        pass
    os._exit(1)


@contextmanager
def _limited_memory(gigabytes: float) -> Iterator[None]:
    """Limit the memory of this process to what it has now and some gigabytes more."""
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    pages = int(Path("/proc/self/statm").read_text().split()[5])  # of data and stack
    limit = pages * resource.getpagesize() + int(gigabytes * 1e9)
    if most != resource.RLIM_INFINITY:
        limit = min(limit, most)
    resource.setrlimit(resource.RLIMIT_DATA, (limit, most))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))
