"""Serve applications on this machine, for one browser, until the user ends it."""

from __future__ import annotations

import asyncio
import socket
from contextlib import closing

import uvicorn
from starlette.types import ASGIApp
from uvicorn.protocols.http.h11_impl import H11Protocol

from nodegraph.errors import NodegraphError
from nodegraph.serve.guard import MOST_BODY, Guard

HOST = "127.0.0.1"
_BACKLOG = 64
_MOST_CONNECTIONS = 64
_PATIENCE = 1
"""Seconds that answers have to end in when the server ends."""
_SILENCE = 5.0
"""Seconds in which a connection must send a whole request."""


class LocalServer:
    """Answers one browser on this machine.

    Parameters
    ----------
    app
        The application that answers; a guard stands before it.
    port
        0 for any that is free.
    most_body
        Bytes of the largest body of a request.

    Attributes
    ----------
    address : str
        Lets one browser in.

    Raises
    ------
    NodegraphError
        If the port is not free.
    """

    def __init__(self, app: ASGIApp, port: int = 0, *, most_body: int = MOST_BODY) -> None:
        self._listener = _listening(port)
        authority = f"{HOST}:{self._listener.getsockname()[1]}"
        guard = Guard(app, authority, most_body)
        self.address = f"http://{authority}/?token={guard.token}"
        self._server = uvicorn.Server(
            uvicorn.Config(
                guard,
                http=_Connection,
                ws="none",
                lifespan="off",
                log_config=None,
                access_log=False,
                proxy_headers=False,
                server_header=False,
                limit_concurrency=_MOST_CONNECTIONS,
                timeout_graceful_shutdown=_PATIENCE,
            )
        )

    def run(self) -> None:
        """Answer until the user interrupts, or `end` is called."""
        with closing(self._listener):
            self._server.run(sockets=[self._listener])

    def end(self) -> None:
        """Have `run` return; called from another thread."""
        self._server.should_exit = True


class _Connection(H11Protocol):
    """A connection that ends when no whole request has come for some seconds.

    uvicorn waits without end for the first request and for the rest of any: connections on which
    nothing comes would keep the browser out.
    """

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request."""
        super().connection_made(transport)
        self._wait()

    def data_received(self, data: bytes) -> None:
        """Wait for the rest of a request, or answer it."""
        super().data_received(data)
        self._wait()

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        super().on_response_complete()
        self._wait()

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no longer."""
        super().connection_lost(exc)
        self._stop()

    def _wait(self) -> None:
        if self.cycle is not None and not self.cycle.response_complete:
            self._stop()
        elif self._deadline is None:
            self._deadline = self.loop.call_later(_SILENCE, self.transport.close)

    def _stop(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


def _listening(port: int) -> socket.socket:
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.bind((HOST, port))
        listener.listen(_BACKLOG)
    except (OSError, OverflowError) as error:
        listener.close()
        raise NodegraphError(f"port {port} cannot be used: {error}; choose another") from error
    return listener
