"""Serve applications on this machine, for one browser, until the user ends it."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import closing
from http import HTTPStatus
from threading import Thread

import uvicorn
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send
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
    make
        Returns the application that answers; a guard stands before it. It is called in a thread of
        its own, while the browser opens, which then waits for it.
    port
        0 for any that is free.
    most_body
        Bytes of the largest body of a request.
    page
        Returns the page at ``/`` if that need not wait for the application.

    Attributes
    ----------
    address : str
        Lets one browser in.

    Raises
    ------
    NodegraphError
        If the port is not free.
    """

    def __init__(
        self,
        make: Callable[[], ASGIApp],
        port: int = 0,
        *,
        most_body: int = MOST_BODY,
        page: Callable[[], ASGIApp] | None = None,
    ) -> None:
        self._make, self._page = make, page
        self._app: Future[ASGIApp] = Future()
        self._app.set_running_or_notify_cancel()  # a request that ends does not end it
        self._listener = _listening(port)
        authority = f"{HOST}:{self._listener.getsockname()[1]}"
        guard = Guard(self._answer, authority, most_body)
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
        """Answer until the user interrupts, or `end` is called.

        Raises
        ------
        Exception
            That with which the application could not be made.
        """
        Thread(target=self._begin, daemon=True).start()
        with closing(self._listener):
            self._server.run(sockets=[self._listener])
        if self._app.done():
            self._app.result()

    def end(self) -> None:
        """Have `run` return; called from another thread."""
        self._server.should_exit = True

    def _begin(self) -> None:
        try:
            self._app.set_result(self._make())
        except BaseException as error:
            self._app.set_exception(error)
            self.end()

    async def _answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            if self._page is not None and scope["path"] == "/":
                answer = self._page()
            else:
                answer = await asyncio.wrap_future(self._app)
        except NodegraphError as error:
            answer = PlainTextResponse(f"{error}\n", HTTPStatus.SERVICE_UNAVAILABLE)
        await answer(scope, receive, send)


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
