"""Requests to an application, byte for byte, as a browser or an attacker would send them."""

from __future__ import annotations

import asyncio
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any
from urllib.parse import unquote

from starlette.types import ASGIApp

HOST = "127.0.0.1:8321"
ORIGIN = f"http://{HOST}"


@dataclass(frozen=True)
class Answer:
    """What an application answered."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def text(self) -> str:
        return self.body.decode()

    @property
    def data(self) -> Any:
        return json.loads(self.body)


def send(
    app: ASGIApp,
    target: str,
    *,
    method: str = "GET",
    body: bytes = b"",
    host: str = HOST,
    leave: bool = False,
    **headers: Any,
) -> Answer:
    """Send one request; an underscore in the name of a header stands for a hyphen.

    With ``leave``, the connection ends with the first part of the answer.
    """
    path, _, query = target.partition("?")
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    pairs = {"host": host, **named}.items()
    scope = {
        "type": "http",
        "asgi": {"version": "3.0", "spec_version": "2.3"},
        "http_version": "1.1",
        "method": method,
        "scheme": "http",
        "path": unquote(path),
        "raw_path": path.encode(),
        "query_string": query.encode(),
        "root_path": "",
        "headers": [(name.encode(), value.encode()) for name, value in pairs],
        "server": ("127.0.0.1", 8321),
        "client": ("127.0.0.1", 50000),
    }
    with ThreadPoolExecutor(1) as thread:  # the loop of a browser may be that of this one
        return thread.submit(asyncio.run, _answer(app, scope, body, leave=leave)).result()


async def _answer(app: ASGIApp, scope: dict[str, Any], body: bytes, *, leave: bool) -> Answer:
    start: dict[str, Any] = {}
    parts: list[bytes] = []
    messages = [{"type": "http.request", "body": body, "more_body": False}]
    answered = asyncio.Event()

    async def receive() -> dict[str, object]:
        if messages:
            return messages.pop()
        await answered.wait()
        return {"type": "http.disconnect"}

    async def take(message: Any) -> None:
        if message["type"] == "http.response.start":
            start.update(message)
        else:
            parts.append(message.get("body", b""))
            if leave or not message.get("more_body"):
                answered.set()

    await app(scope, receive, take)
    headers = {name.decode(): value.decode() for name, value in start["headers"]}
    return Answer(start["status"], headers, b"".join(parts))
