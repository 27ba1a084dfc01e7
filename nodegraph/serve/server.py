"""Serve an application on this machine, for one browser, until the user ends it."""

from __future__ import annotations

import socket
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import uvicorn

from nodegraph.errors import NodegraphError
from nodegraph.plugin.registry import Registry
from nodegraph.serve.app import application
from nodegraph.serve.guard import Guard
from nodegraph.serve.runs import OpenRuns

HOST = "127.0.0.1"
_BACKLOG = 64
_MOST_CONNECTIONS = 64
_PATIENCE = 1
"""Seconds that answers have to end in when the server ends."""


def serve(
    paths: list[Path],
    registry: Registry,
    *,
    store: Path | None,
    port: int,
    ready: Callable[[str], None],
) -> None:
    """Serve runs until the user interrupts.

    Parameters
    ----------
    paths
        Folders of runs, or folders that hold runs.
    registry
    store
        The folder of stored results; by default where the runs stored them.
    port
        0 for any that is free.
    ready
        Called with the address, which lets one browser in, once it answers.

    Raises
    ------
    NodegraphError
        If a folder is no run, or the port is not free.
    KeyboardInterrupt
    """
    runs = OpenRuns(paths, registry, store)
    with closing(_listening(port)) as listener:
        authority = f"{HOST}:{listener.getsockname()[1]}"
        guard = Guard(application(runs), authority)
        config = uvicorn.Config(
            guard,
            http="h11",
            ws="none",
            lifespan="off",
            log_config=None,
            access_log=False,
            proxy_headers=False,
            server_header=False,
            limit_concurrency=_MOST_CONNECTIONS,
            timeout_graceful_shutdown=_PATIENCE,
        )
        ready(f"http://{authority}/?token={guard.token}")
        uvicorn.Server(config).run(sockets=[listener])


def _listening(port: int) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.bind((HOST, port))
        listener.listen(_BACKLOG)
    except (OSError, OverflowError) as error:
        listener.close()
        raise NodegraphError(f"port {port} cannot be used: {error}; choose another") from error
    return listener
