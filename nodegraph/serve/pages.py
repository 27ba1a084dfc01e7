"""Pages of the server's own, with the policy that they state."""

from __future__ import annotations

import asyncio
import html
import json
import re
from collections.abc import AsyncIterator, Callable, Iterable, Mapping
from http import HTTPStatus
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, Response, StreamingResponse

from nodegraph.report.page import filled, source

_EVERY = 0.2
"""Seconds between two looks."""

_POLICY = re.compile('http-equiv="Content-Security-Policy" content="([^"]*)"')


def page_response(
    template: str,
    status: HTTPStatus = HTTPStatus.OK,
    *,
    scripts: Iterable[str] = (),
    styles: Iterable[str] = (),
    trusted: Iterable[str] = (),
    package: str = "nodegraph.serve",
    **context: Any,
) -> Response:
    """Return a page of the server's own, from a template of a package."""
    content = filled(
        package,
        template,
        scripts=scripts,
        styles=[own_source("serve.css"), *styles],
        trusted=trusted,
        rules={"form-action": "'self'", "connect-src": "'self'"},
        **context,
    )
    return html_response(content, status)


def events_response(
    look: Callable[[], Mapping[str, Any]], is_last: Callable[[Mapping[str, Any]], bool]
) -> Response:
    """Send what each look gives that differs from the one before, until the last."""

    async def stream() -> AsyncIterator[str]:
        last = None
        while True:
            data = await run_in_threadpool(look)
            if data != last:
                yield f"data: {json.dumps(data)}\n\n"
            if is_last(data):
                return
            last = data
            await asyncio.sleep(_EVERY)

    return StreamingResponse(stream(), media_type="text/event-stream")


def html_response(content: str, status: HTTPStatus = HTTPStatus.OK) -> Response:
    """Return a page, with the policy that it states, and its forms lead here only."""
    stated = _POLICY.search(content)
    rules = html.unescape(stated[1]) if stated else "default-src 'none'"
    own = f"{rules}; frame-ancestors 'none'"
    return HTMLResponse(
        content.encode(errors="backslashreplace"),
        status,
        headers={"Content-Security-Policy": own},
    )


def own_source(name: str) -> str:
    """Return a style or a script of the server's pages."""
    return source(name, "nodegraph.serve")


def json_in_script(value: object) -> str:
    """Return data for a script in a page."""
    return json.dumps(value).replace("<", "\\u003c")
