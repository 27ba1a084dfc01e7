"""Addresses of schedulers, and whether one answers there."""

from __future__ import annotations

import asyncio
import re
import socket
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from distributed import Security, rpc

from nodegraph.errors import NodegraphError

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
