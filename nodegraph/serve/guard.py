"""Refuses requests that are not of the browser which opened the printed address.

Every page on the internet can send requests to a server on this machine, and a name that such a
page controls can be made to lead here (DNS rebinding). So a request must name this server's own
address in ``Host``, must not come from another origin, and must carry the session's cookie, which
the browser gets for a token that is valid once. Answers are neither stored nor shown in frames,
and their content is never guessed.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterable
from http import HTTPStatus
from typing import NamedTuple

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

MOST_BODY = 1 << 16
"""Bytes of an address, and of a body unless the application takes larger ones."""

_OWN = ("", "same-origin", "none")
"""Values of the header Sec-Fetch-Site in requests from the server's own pages or the user."""

_HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
_POLICY = "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
# a redirect would belong to the request of the page on which the address was clicked, and a strict
# cookie is not sent with that; a refresh is a request of this page
_ENTER = (
    '<!DOCTYPE html><html lang="en"><meta charset="utf-8"><title>nodegraph</title>'
    '<meta http-equiv="refresh" content="0; url=/"><p><a href="/">Open the page</a></p></html>'
)
_HOW = "open the address that the command printed, or start it again for a new one"


class Refused(NamedTuple):
    """Why a request is not answered."""

    status: HTTPStatus
    reason: str


class Guard:
    """Passes requests on to an application that it protects.

    Parameters
    ----------
    app
    authority
        The server's own address, as a browser writes it: ``127.0.0.1:8321``.
    most_body
        Bytes of the largest body.

    Attributes
    ----------
    token : str
        Is exchanged for the session's cookie, once.
    """

    def __init__(self, app: ASGIApp, authority: str, most_body: int = MOST_BODY) -> None:
        self._app = app
        self._most_body = most_body
        self._authority = authority
        # cookies of one host reach all its ports
        self._cookie = f"nodegraph-{authority.rpartition(':')[2]}"
        self._session = secrets.token_urlsafe(32)
        self._is_used = False
        self.token = secrets.token_urlsafe(32)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or refuse it."""
        if scope["type"] != "http":
            return
        answer = self._answer(scope)
        if isinstance(answer, Refused):
            answer = PlainTextResponse(f"{answer.reason}\n", answer.status)
        await answer(scope, receive, _with_headers(send))

    def _answer(self, scope: Scope) -> ASGIApp | Refused:
        """Return the response to a request."""
        refused = self._refusal(scope)
        if refused is not None:
            return refused
        cookies = _cookies(Headers(scope=scope).getlist("cookie"), self._cookie)
        has_session = any(_equal(cookie, self._session) for cookie in cookies)
        token = Request(scope).query_params.get("token")
        if token is not None and scope["method"] == "GET" and scope["path"] == "/":
            return self._enter(token, has_session=has_session)
        return self._app if has_session else Refused(HTTPStatus.FORBIDDEN, f"no session: {_HOW}")

    def _refusal(self, scope: Scope) -> Refused | None:
        """Return why a request is refused whoever sends it."""
        headers = Headers(scope=scope)
        if headers.getlist("host") != [self._authority]:
            return Refused(HTTPStatus.MISDIRECTED_REQUEST, "this is not the server of that name")
        if scope["method"] not in ("GET", "POST"):
            return Refused(HTTPStatus.METHOD_NOT_ALLOWED, "only GET and POST are answered")
        own = f"http://{self._authority}"
        origins = headers.getlist("origin")
        if origins != [own] and (origins or scope["method"] == "POST"):
            return Refused(HTTPStatus.FORBIDDEN, "requests of other origins are not answered")
        is_visit = scope["method"] == "GET" and headers.get("sec-fetch-mode") == "navigate"
        if headers.get("sec-fetch-site", "") not in _OWN and not is_visit:
            return Refused(HTTPStatus.FORBIDDEN, "requests of other sites are not answered")
        if len(scope["raw_path"]) + len(scope["query_string"]) > MOST_BODY:
            return Refused(HTTPStatus.REQUEST_URI_TOO_LONG, "the address is too long")
        return _body_refusal(headers, self._most_body) if scope["method"] == "POST" else None

    def _enter(self, token: str, *, has_session: bool) -> ASGIApp | Refused:
        """Exchange a token for the cookie; a browser that has the cookie needs none."""
        response = HTMLResponse(_ENTER)
        if has_session:
            return response
        if self._is_used or not _equal(token, self.token):
            reason = (
                "was opened in another browser, or by another program: go on there, or start the "
                "command again for a new address"
                if _equal(token, self.token)
                else f"is of another session: {_HOW}"
            )
            return Refused(HTTPStatus.FORBIDDEN, f"this address {reason}")
        self._is_used = True
        response.set_cookie(self._cookie, self._session, httponly=True, samesite="strict")
        return response


def _body_refusal(headers: Headers, most: int) -> Refused | None:
    """Return why a body is refused; forms of other sites cannot send JSON."""
    length = headers.get("content-length", "")
    if "transfer-encoding" in headers or not length.isdecimal():
        return Refused(HTTPStatus.LENGTH_REQUIRED, "the length of the body is missing")
    if int(length[:9]) > most or len(length) > 9:
        return Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "the body is too long")
    if headers.get("content-type") != "application/json":
        return Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "the body is not JSON")
    return None


def _cookies(headers: Iterable[str], name: str) -> Iterable[str]:
    # other servers of this host set cookies, too, also of that name, and theirs may be malformed
    for header in headers:
        for cookie in header.split(";"):
            given, _, value = cookie.strip().partition("=")
            if given == name:
                yield value


def _equal(text: str, secret: str) -> bool:
    return secrets.compare_digest(text.encode("utf-8", "replace"), secret.encode())


def _with_headers(send: Send) -> Send:
    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers[name] = value
            headers.setdefault("Content-Security-Policy", _POLICY)
        await send(message)

    return send_with_headers
