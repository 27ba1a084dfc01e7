"""The command serves one browser on this machine, until it is interrupted."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import stat
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from email.message import Message
from http.client import HTTPConnection
from pathlib import Path
from threading import Thread
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import urlopen

import pytest
from playwright.sync_api import Page
from starlette.responses import PlainTextResponse

import nodegraph as ng
from nodegraph.execute.events import Event
from nodegraph.runs.folder import RunFolder
from nodegraph.serve import server
from tests.browser import middle, needs_axe, until, violations

_OPEN = ("open", "runs/toy")
_EDIT = ("edit", "toy.yaml")
_BROWSER = """\
#!{python}
# a browser that ends when it is closed
import sys, time
from pathlib import Path
Path("opening").write_text(" ".join(sys.argv[1:]))
Path("opening").rename("opened")
for _ in range(300):
    if Path("closed").exists():
        break
    time.sleep(0.1)
"""
_SLOW = """\
import time
from pathlib import Path

while not Path("asked").exists():
    time.sleep(0.01)
no_such_name
"""


@contextmanager
def served(*words: str, **environment: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Start a command; yield the address that it prints."""
    with subprocess.Popen(
        [sys.executable, "-m", "nodegraph.cli.main", *words],
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env={**os.environ, **environment},
    ) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip(), process
        finally:
            process.kill()


def test_a_browser_opens_the_address_once(folder: Path, tab: Page) -> None:
    shutil.rmtree("store")
    words = ("--plugin", "toys.py", "--store", "store", "--no-browser")
    with served(*_OPEN, *words) as (address, process):
        host, _, _ = address.partition("/?token=")
        assert host.startswith("http://127.0.0.1:")
        tab.goto(address)
        tab.wait_for_selector(".served-bar")
        assert urlsplit(tab.url).query == ""
        assert tab.evaluate("document.querySelector('h1').textContent") == "<script>bad()</script>"
        assert tab.evaluate("document.cookie") == ""
        until(tab, "window.packed")  # computed, as the store is gone
        assert tab.evaluate("window.packed.inputs") == {"hold": {"estimate": 6, "truth": 5}}
        tab.goto(f"{host}/value?node=fill&at.start=1&at.fill=hold")
        tab.click("#compute")
        tab.wait_for_selector(".rendered")
        assert tab.evaluate("document.querySelector('.rendered').textContent.trim()") == "2.0"
        with pytest.raises(HTTPError, match="403"):
            urlopen(address)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        assert (process.returncode, "Traceback" in errors) == (130, False)


@needs_axe
def test_cards_show_states_and_lead_to_values_while_a_run_goes_on(folder: Path, tab: Page) -> None:
    graph = ng.load("toy.yaml", plugins=["toys.py"])
    events: list[Event] = []
    ng.run(graph, store="other", listeners=[events.append])
    going = RunFolder(Path("runs/going"), graph.spec.text)
    going.hear(events[0])
    words = ("--plugin", "toys.py", "--store", "store", "--no-browser")
    with served(*_OPEN, *words) as (address, _):
        tab.goto(address)
        host = address.partition("/?token=")[0]
        tab.goto(f"{host}/?run=going")
        assert cards(tab)["fill"] == ("4 waiting", "waiting")
        for event in events[1:-3]:
            going.hear(event)
        until(tab, "/refused, 3 done/.test(document.querySelector('[data-box=fill]').textContent)")
        assert cards(tab)["fill"] == ("1 of 4 refused, 3 done", "refused")
        assert cards(tab)["table"] == ("1 waiting", "waiting")
        going.close()
        tab.goto(f"{host}/values?run=toy")
        assert cards(tab)["error"] == ("1 of 4 skipped, 3 done", "skipped")
        assert violations(tab) == []
        tab.emulate_media(color_scheme="dark")
        assert violations(tab, rules=("color-contrast",)) == []
        borders = tab.evaluate(
            "[...document.querySelectorAll('.served-legend .frame')].map((frame) => { const"
            " { strokeDasharray, strokeWidth } = getComputedStyle(frame);"
            " return strokeDasharray + strokeWidth; })"
        )
        assert len(set(borders)) == len(borders) == 3
        tab.focus('a:has(> [data-arrow="a.output fill.x"])')
        tab.wait_for_selector(".served-flow b")
        assert "a.output to fill.x: 2 values, float" in tab.inner_text(".served-flow")
        tab.mouse.move(*middle(tab, "[data-arrow='fill.output error.estimate'] .near"))
        until(tab, "/^fill.output to error/.test(document.querySelector('.served-flow').innerText)")
        assert "size 1 to 6 mm" in tab.inner_text(".served-flow")
        tab.focus(".served-bar a")
        assert tab.get_by_role("link", name=re.compile("fill.*1 of 4 refused")).count() == 1
        while not tab.evaluate("document.activeElement.matches(':has(> [data-box=fill])')"):
            tab.keyboard.press("Tab")
        tab.keyboard.press("Enter")
        tab.wait_for_selector(".served-combinations")
        assert violations(tab) == []
        assert tab.locator("tbody tr").first.inner_text().split("\t")[1:] == [
            "refused",
            "too large",
        ]
        tab.click("text=start=1, fill=hold")
        tab.wait_for_selector(".rendered")
        assert tab.evaluate("document.querySelector('.rendered').textContent.trim()") == "2.0"


def cards(tab: Page) -> dict[str, tuple[str, str]]:
    """Return the text and the mark of each card."""
    found = tab.evaluate(
        "[...document.querySelectorAll('[data-box]')].map((box) => [box.dataset.box,"
        " box.querySelector('title').textContent, box.dataset.state])"
    )
    return {name: (title.partition(": ")[2], state) for name, title, state in found}


def test_a_browser_is_sent_to_the_address_by_a_private_file(folder: Path, tab: Page) -> None:
    browser = folder / "browser"
    browser.write_text(_BROWSER.format(python=sys.executable))
    browser.chmod(0o700)
    environment = {"BROWSER": str(browser), "DISPLAY": ":0", "TMPDIR": str(folder)}
    with served(*_OPEN, "--plugin", "toys.py", **environment) as (address, process):
        words = when_there(folder / "opened").read_text()
        assert address.partition("=")[2] not in words
        page = Path(urlsplit(words).path)
        assert [stat.S_IMODE(each.stat().st_mode) for each in (page.parent, page)] == [0o700, 0o600]
        tab.goto(words)  # is answered though the browser has not ended
        tab.wait_for_selector(".served-bar")
        process.send_signal(signal.SIGINT)
        assert process.wait() == 130
        assert not page.parent.exists()
        (folder / "closed").touch()


@pytest.mark.parametrize("command", [_OPEN, _EDIT])
def test_no_other_program_is_answered(folder: Path, command: tuple[str, ...]) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with served(*command, "--plugin", "toys.py", "--no-browser") as (address, process):
        place = urlsplit(address)
        origin = f"http://{place.netloc}"
        status, headers = answer_of(place.netloc, "GET", f"/?{place.query}")
        cookie = str(headers["Set-Cookie"]).partition(";")[0]
        own = {"Cookie": cookie, "Origin": origin, "Sec-Fetch-Site": "same-origin"}
        assert (status, answer_of(place.netloc, "GET", "/", own)[0]) == (200, 200)
        for attack, wanted in (
            ({}, 403),
            ({"Cookie": cookie.partition("=")[0] + "=guess"}, 403),
            ({"Cookie": cookie, "Origin": "https://attacker.example"}, 403),
            ({"Cookie": cookie, "Origin": "null"}, 403),
            ({"Cookie": cookie, "Host": "attacker.example"}, 421),
            ({"Cookie": cookie, "Sec-Fetch-Site": "cross-site"}, 403),
        ):
            for method, target in (("GET", "/view"), ("POST", "/edit"), ("POST", "/compute")):
                assert answer_of(place.netloc, method, target, attack)[0] == wanted
        assert answer_of(place.netloc, "POST", "/edit", {"Cookie": cookie})[0] == 403
        size = {**own, "Content-Length": str(1 << 30)}
        assert answer_of(place.netloc, "POST", "/edit", size)[0] == 413
        for path in ("/../toys.py", "/%2e%2e/toys.py", "/toy.yaml", "/etc/passwd", "//etc/passwd"):
            assert answer_of(place.netloc, "GET", path, own)[0] == 404
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
        assert (process.returncode, "Traceback" in errors) == (130, False)
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before


def answer_of(
    place: str, method: str, target: str, headers: Mapping[str, str] | None = None
) -> tuple[int, Message]:
    """Return the status and the headers of an answer; nothing of a body is sent."""
    connection = HTTPConnection(place, timeout=30)
    named = {"Content-Length": "2", "Content-Type": "application/json"} if method == "POST" else {}
    named |= headers or {}
    connection.putrequest(method, target, skip_host="Host" in named)
    for name, value in named.items():
        connection.putheader(name, value)
    connection.endheaders(b"{}" if method == "POST" else None)
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer.status, answer.headers


@pytest.mark.parametrize("sent", [b"", b"GET / HTTP/1.1\r\n", b"GET / HTTP/1.1\r\n\r\nGET "])
def test_a_connection_on_which_no_whole_request_comes_is_closed(
    monkeypatch: pytest.MonkeyPatch, sent: bytes
) -> None:
    monkeypatch.setattr(server, "_SILENCE", 0.1)
    served = server.LocalServer(lambda: PlainTextResponse("secret"))
    answering = Thread(target=served.run)
    answering.start()
    with socket.create_connection((server.HOST, urlsplit(served.address).port or 0)) as silent:
        silent.settimeout(30)
        silent.sendall(sent)
        while silent.recv(4096):
            pass
    assert urlopen(served.address).status == 200
    served.end()
    answering.join()


@pytest.mark.parametrize("words", [_OPEN, _EDIT])
def test_a_plugin_that_cannot_be_loaded_ends_the_command(
    words: tuple[str, ...], folder: Path
) -> None:
    Path("slow.py").write_text(_SLOW)
    with served(*words, "--plugin", "slow.py", "--no-browser") as (address, process):
        place = urlsplit(address)
        connection = HTTPConnection(place.netloc, timeout=60)
        connection.request("GET", f"/?{place.query}")
        answer = connection.getresponse()
        answer.read()
        cookie = str(answer.headers["Set-Cookie"]).partition(";")[0]
        connection.request("GET", "/runs", headers={"Cookie": cookie})
        Path("asked").touch()
        assert connection.getresponse().status == 503
        _, errors = process.communicate()
        connection.close()
    assert process.returncode == 2
    assert "nodegraph: slow.py: the plugin does not import: NameError" in errors
    assert "Traceback" not in errors


def when_there(path: Path) -> Path:
    for _ in range(300):
        if path.exists():
            return path
        time.sleep(0.1)
    raise AssertionError(f"{path} has not come")
