"""Calls as messages: found, made and answered in another process, or a reason why not."""

from __future__ import annotations

import json
import sys
import threading
import warnings
from collections.abc import Iterator
from multiprocessing.connection import Pipe
from typing import Any

import numpy as np
import pytest

from nodegraph.execute import messages
from nodegraph.execute.messages import respond
from nodegraph.execute.worker import receive, send
from nodegraph.store import Packer

FILE = """
import threading, warnings
from nodegraph import node

BOTH = threading.Barrier(2, timeout=20)

@node("carried.number")
def number(*, k: int = 0) -> int:
    return NUMBER

@node("carried.warns")
def warns(x: int) -> int:
    BOTH.wait()
    warnings.warn(f"number {x}", stacklevel=2)
    BOTH.wait()
    return x
"""


@pytest.fixture(autouse=True)
def forget(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Respond as a new process does."""
    monkeypatch.setattr(messages, "_plugins", {})
    monkeypatch.setattr(messages, "_imported", set())
    yield
    for name in ("carried", "broken"):
        sys.modules.pop(name, None)


def ask(
    plugin: str, name: str, file: str = "", *, head: bytes = b"", **inputs: object
) -> tuple[dict[str, Any], list[object]]:
    """Send a request with a plugin file that is not on this machine."""
    files = [(f"/elsewhere/{plugin}.py", file)] if file else []
    packed = Packer().pack((inputs, {}))
    address = json.dumps([plugin, name, "", None, "", ""]).encode()
    texts = (json.dumps(files).encode(), address, head or packed.head.encode())
    about, *frames = respond([*texts, *packed.buffers])
    return json.loads(bytes(about)), json.loads(bytes(frames[0]))


def test_each_call_collects_its_own_warnings() -> None:
    before = warnings.showwarning
    answers: dict[int, list[str]] = {}

    def work(number: int) -> None:
        answers[number] = ask("carried", "carried.warns", FILE, x=number)[0]["warnings"]

    both = [threading.Thread(target=work, args=(number,)) for number in (1, 2)]
    for thread in both:
        thread.start()
    for thread in both:
        thread.join()
    assert answers == {1: ["number 1"], 2: ["number 2"]}
    assert warnings.showwarning is before


def test_a_plugin_file_comes_along_as_its_sender_has_it() -> None:
    texts = [FILE.replace("NUMBER", number) for number in ("1", "2", "1")]
    values = [ask("carried", "carried.number", text)[1] for text in texts]
    assert values == [["tuple", 1], ["tuple", 2], ["tuple", 1]]


def test_a_plugin_file_that_does_not_import_is_reported() -> None:
    about, _ = ask("broken", "broken.x", "import no_such")
    assert about["missing"].startswith("cannot use a plugin file: ")
    assert "no_such" in about["missing"]


@pytest.mark.parametrize(
    ("file", "name", "reason"),
    [
        (
            "",
            "elsewhere.none",
            "has no plugin 'elsewhere', which defines elsewhere.none; install it there",
        ),
        (
            "from nodegraph import node",
            "elsewhere.none",
            "has no node elsewhere.none in its plugin 'elsewhere'",
        ),
    ],
)
def test_a_missing_node_is_reported(file: str, name: str, reason: str) -> None:
    assert ask("elsewhere", name, file)[0] == {"missing": reason}


def test_values_that_cannot_be_unpacked_are_reported() -> None:
    about, _ = ask("carried", "carried.number", FILE, head=b'["value","no_such:Class",[]]')
    assert list(about) == ["unsendable"]


def test_buffers_arrive_as_they_were_and_cannot_be_written_to() -> None:
    here, there = Pipe()
    array = np.random.default_rng(0).normal(size=200_000)  # far more than a connection holds
    sent = [b"", b"head", array.view(np.uint8).data]
    sending = threading.Thread(target=send, args=(here, sent))
    sending.start()
    got = receive(there)
    sending.join()
    assert [bytes(frame) for frame in got] == [bytes(frame) for frame in sent]
    assert all(isinstance(frame, memoryview) and frame.readonly for frame in got)


@pytest.mark.parametrize("sent", [[], [b"[9]"], [b"[9]", b"short"]])
def test_an_end_in_the_middle_is_no_message(sent: list[bytes]) -> None:
    here, there = Pipe()
    for piece in sent:
        here.send_bytes(piece)
    here.close()
    with pytest.raises(EOFError):
        receive(there)
