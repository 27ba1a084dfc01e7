from __future__ import annotations

import json
import sys
import threading
import warnings
from pathlib import Path

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
    """Respond as a new process does."""
    monkeypatch.setattr(server, "_finders", {})
    monkeypatch.setattr(server, "_plugin_files", set())


def ask(
    plugin: str, name: str, *, files: tuple[tuple[str, bytes], ...] = (), **inputs: object
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


def test_each_call_collects_its_own_warnings() -> None:
    before = warnings.showwarning
    answers: dict[int, Response] = {}

    def work(number: int) -> None:
        answers[number] = ask("given", "threads.warns", x=number)

    both = [threading.Thread(target=work, args=(number,)) for number in (1, 2)]
    for thread in both:
        thread.start()
    for thread in both:
        thread.join()
    assert {number: response.outcome.warnings for number, response in answers.items()} == {
        1: ("number 1",),
        2: ("number 2",),
    }
    assert warnings.showwarning is before


def test_a_plugin_file_that_does_not_exist_here_is_copied(tmp_path: Path) -> None:
    gone = str(tmp_path / "elsewhere" / "carried.py")
    results = [
        ask("carried", "carried.number", files=((gone, FILE.format(number).encode()),)).head
        for number in (1, 2, 1)
    ]
    assert [json.loads(head) for head in results] == [["tuple", 1], ["tuple", 2], ["tuple", 1]]
    sys.modules.pop("carried")


def test_a_plugin_file_that_does_not_import_is_reported(tmp_path: Path) -> None:
    response = ask("broken", "broken.x", files=((str(tmp_path / "broken.py"), b"import no_such"),))
    assert response.kind == ResponseKind.MISSING
    assert "cannot use a plugin file" in response.outcome.reason
    assert "no_such" in response.outcome.reason


def test_a_missing_node_is_reported() -> None:
    response = ask("acme", "acme.none")
    assert (response.kind, response.outcome.reason) == (
        ResponseKind.MISSING,
        "has no plugin 'acme', which defines acme.none; install it there",
    )


def test_a_value_that_cannot_be_unpacked_is_reported() -> None:
    address = NodeAddress("given", "threads.warns", "", __name__, "warns").encode()
    around = Environment().encode()
    response = respond(Request(around, address, b'["value","no_such:Class",[]]'))
    assert response.kind == ResponseKind.UNSENDABLE


def test_a_function_inside_another_has_no_address() -> None:
    @node("inside.one")
    def inside(x: int) -> int:
        return x

    described = node_of(inside)
    assert described is not None
    assert NodeAddress.of(Call(0, described, "given", {}, {}), Registry(), None) is None
