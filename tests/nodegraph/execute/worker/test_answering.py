from __future__ import annotations

import json
import sys
import threading
import warnings
from pathlib import Path
from typing import Any

import pytest

from nodegraph import node
from nodegraph.execute.call import Call
from nodegraph.execute.worker import server
from nodegraph.execute.worker.protocol import (
    Environment,
    NodeAddress,
    Request,
    Response,
    ResponseKind,
)
from nodegraph.execute.worker.server import respond
from nodegraph.node.decorator import node_of
from nodegraph.plugin.registry import Registry
from nodegraph.store import Packer

BOTH = threading.Barrier(2, timeout=20)
FILE = """
from nodegraph import node

@node("carried.number")
def number(*, k: int = 0) -> int:
    return {}
"""


@pytest.fixture(autouse=True)
def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answer as a process that has not answered yet."""
    monkeypatch.setattr(server, "_finders", {})
    monkeypatch.setattr(server, "_plugin_files", set())


def ask(
    plugin: str, name: str, *, files: tuple[tuple[str, bytes], ...] = (), **inputs: Any
) -> Response:
    packed = Packer().pack((inputs, {}))
    address = NodeAddress(plugin, name, "", __name__, name.rpartition(".")[2])
    around = Environment(files).encode()
    return respond(Request(around, address.encode(), packed.head.encode(), packed.buffers))


@node("threads.warns")
def warns(x: int) -> int:
    BOTH.wait()
    warnings.warn(f"number {x}", stacklevel=2)
    BOTH.wait()
    return x


def test_threads_hear_their_own_warnings() -> None:
    before = warnings.showwarning
    answers: dict[int, Response] = {}

    def work(number: int) -> None:
        answers[number] = ask("given", "threads.warns", x=number)

    both = [threading.Thread(target=work, args=(number,)) for number in (1, 2)]
    for one in both:
        one.start()
    for one in both:
        one.join()
    assert {number: one.outcome.warnings for number, one in answers.items()} == {
        1: ("number 1",),
        2: ("number 2",),
    }
    assert warnings.showwarning is before


def test_a_file_that_is_not_there_is_laid_down(tmp_path: Path) -> None:
    gone = str(tmp_path / "elsewhere" / "carried.py")
    results = [
        ask("carried", "carried.number", files=((gone, FILE.format(number).encode()),)).head
        for number in (1, 2, 1)
    ]
    assert [json.loads(one) for one in results] == [["tuple", 1], ["tuple", 2], ["tuple", 1]]
    sys.modules.pop("carried")


def test_a_file_that_does_not_import_is_told(tmp_path: Path) -> None:
    said = ask("broken", "broken.x", files=((str(tmp_path / "broken.py"), b"import no_such"),))
    assert said.kind == ResponseKind.MISSING
    assert "cannot use a plugin file" in said.outcome.reason
    assert "no_such" in said.outcome.reason


def test_a_node_that_is_not_here_is_told() -> None:
    said = ask("acme", "acme.none")
    assert (said.kind, said.outcome.reason) == (
        ResponseKind.MISSING,
        "has no plugin 'acme', which defines acme.none; install it there",
    )


def test_what_cannot_be_unpacked_is_sent_back() -> None:
    address = NodeAddress("given", "threads.warns", "", __name__, "warns").encode()
    around = Environment().encode()
    said = respond(Request(around, address, b'["value","no_such:Class",[]]'))
    assert said.kind == ResponseKind.UNSENDABLE


def test_a_function_inside_another_has_no_address() -> None:
    @node("inside.one")
    def inside(x: int) -> int:
        return x

    found = node_of(inside)
    assert found is not None
    assert NodeAddress.of(Call(0, found, "given", {}, {}), Registry()) is None
