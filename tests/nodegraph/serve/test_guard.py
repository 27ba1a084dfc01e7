"""Only the browser that opened the printed address is answered, whatever else sends requests."""

from __future__ import annotations

from typing import Any

import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send

from nodegraph.serve.guard import MOST_BODY, Guard
from tests.nodegraph.serve.requests import HOST, ORIGIN, Answer, send

JSON: dict[str, Any] = {"content_type": "application/json", "content_length": "2"}


async def secret(scope: Scope, receive: Receive, send: Send) -> None:
    await PlainTextResponse("secret")(scope, receive, send)


@pytest.fixture
def guard() -> Guard:
    return Guard(secret, HOST)


@pytest.fixture
def cookie(guard: Guard) -> str:
    return cookie_of(send(guard, f"/?token={guard.token}"))


def cookie_of(answer: Answer) -> str:
    assert answer.status == 200
    assert "secret" not in answer.text
    cookie, *attributes = answer.headers["set-cookie"].split("; ")
    assert {"HttpOnly", "SameSite=strict"} <= set(attributes)
    return cookie


def refused(answer: Answer, status: int) -> bool:
    assert "secret" not in answer.text
    assert "set-cookie" not in answer.headers
    return answer.status == status


def test_the_printed_address_opens_a_session(guard: Guard, cookie: str) -> None:
    answer = send(guard, "/value", cookie=cookie)
    assert (answer.status, answer.text) == (200, "secret")
    assert answer.headers["cache-control"] == "no-store"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["referrer-policy"] == "no-referrer"
    assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
    assert not [name for name in answer.headers if name.startswith("access-control")]


@pytest.mark.parametrize(
    "host", ["attacker.example:8321", "localhost:8321", "127.0.0.1", "127.0.0.1:80", f"{HOST}.", ""]
)
def test_another_name_for_this_machine_is_refused(guard: Guard, cookie: str, host: str) -> None:
    assert refused(send(guard, "/", host=host, cookie=cookie), 421)
    assert refused(send(guard, f"/?token={guard.token}", host=host), 421)


@pytest.mark.parametrize(
    "origin", ["https://attacker.example", "null", "http://127.0.0.1:8322", f"{ORIGIN}.example", ""]
)
def test_pages_of_other_origins_are_refused(guard: Guard, cookie: str, origin: str) -> None:
    assert refused(send(guard, "/detail", cookie=cookie, origin=origin), 403)
    assert refused(send(guard, "/", method="POST", cookie=cookie, origin=origin, **JSON), 403)


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_requests_that_other_sites_cause_are_refused(guard: Guard, cookie: str, site: str) -> None:
    assert refused(send(guard, "/detail", cookie=cookie, sec_fetch_site=site), 403)
    visit: dict[str, Any] = {"sec_fetch_site": site, "sec_fetch_mode": "navigate"}
    assert send(guard, f"/?token={guard.token}", cookie=cookie, **visit).status == 200  # a link


@pytest.mark.parametrize("value", [None, "", "nodegraph-8321=", "nodegraph-8321=guess", "a=b; =;"])
def test_without_the_cookie_nothing_is_answered(guard: Guard, value: str | None) -> None:
    headers: dict[str, Any] = {} if value is None else {"cookie": value}
    assert refused(send(guard, "/", **headers), 403)
    assert refused(send(guard, "/", method="POST", origin=ORIGIN, **JSON, **headers), 403)


@pytest.mark.parametrize("foreign", ['a="b', "a[b]={1, 2}", "=", "b@d:name=1", "é=ü", "a;;b"])
def test_a_malformed_cookie_of_another_server_does_not_matter(
    guard: Guard, cookie: str, foreign: str
) -> None:
    for value in (f"{foreign}; {cookie}", f"{cookie}; {foreign}", f"{foreign};{cookie};{foreign}"):
        assert send(guard, "/", cookie=value).text == "secret"


def test_another_server_s_cookie_of_that_name_does_not_end_a_session(
    guard: Guard, cookie: str
) -> None:
    other = f"{cookie.partition('=')[0]}=other"
    for value in (f"{other}; {cookie}", f"{cookie}; {other}"):
        assert send(guard, "/", cookie=value).text == "secret"


def test_a_token_lets_one_browser_in(guard: Guard, cookie: str) -> None:
    address = f"/?token={guard.token}"
    other = send(guard, address)
    assert refused(other, 403)
    assert "another browser" in other.text
    again = send(guard, address, cookie=cookie)  # the same browser goes back to it
    assert (again.status, "set-cookie" in again.headers) == (200, False)
    wrong = send(guard, "/?token=guess")
    assert refused(wrong, 403)
    assert "another session" in wrong.text
    assert refused(send(guard, "/?token="), 403)
    assert refused(send(guard, f"/value?token={guard.token}"), 403)


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 403),
        ({"origin": ORIGIN, "content_length": "2", "content_type": "text/plain"}, 415),
        (
            {
                "origin": ORIGIN,
                "content_length": "2",
                "content_type": "application/x-www-form-urlencoded",
            },
            415,
        ),
        ({"origin": ORIGIN, "content_type": "application/json"}, 411),
        ({"origin": ORIGIN, **JSON, "transfer_encoding": "chunked"}, 411),
        ({"origin": ORIGIN, **JSON, "content_length": str(MOST_BODY + 1)}, 413),
        ({"origin": ORIGIN, **JSON, "content_length": "9" * 5000}, 413),
        ({"origin": ORIGIN, **JSON, "content_length": "-1"}, 411),
    ],
)
def test_forms_and_odd_bodies_are_refused(
    guard: Guard, cookie: str, headers: dict[str, Any], status: int
) -> None:
    assert refused(send(guard, "/", method="POST", body=b"{}", cookie=cookie, **headers), status)
    good: dict[str, Any] = {"origin": ORIGIN, **JSON}
    assert send(guard, "/", method="POST", body=b"{}", cookie=cookie, **good).text == "secret"


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "HEAD", "TRACE"])
def test_other_methods_are_refused(guard: Guard, cookie: str, method: str) -> None:
    assert refused(send(guard, "/", method=method, cookie=cookie, origin=ORIGIN), 405)


def test_long_addresses_are_refused(guard: Guard, cookie: str) -> None:
    assert refused(send(guard, f"/?{'x' * MOST_BODY}", cookie=cookie), 414)
