from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from io import BufferedReader, BufferedWriter
from pathlib import Path

import numpy as np
import pytest

from nodegraph.execute.call import Outcome
from nodegraph.execute.worker.protocol import (
    Request,
    Response,
    ResponseKind,
    code_of,
    reached,
    read_frames,
    write_frames,
)
from nodegraph.state import State

Pipe = tuple[BufferedReader, BufferedWriter]


@pytest.fixture
def pipe() -> Iterator[Pipe]:
    read, write = os.pipe()
    with os.fdopen(read, "rb") as reader, os.fdopen(write, "wb") as writer:
        yield reader, writer


def test_frames_arrive_as_they_were_and_cannot_be_written_to(pipe: Pipe) -> None:
    reader, writer = pipe
    array = np.random.default_rng(0).normal(size=200_000)  # far more than a pipe holds
    sent = [b"", b"head", array.view(np.uint8).data]
    sending = threading.Thread(target=write_frames, args=(writer, sent))
    sending.start()
    got = read_frames(reader)
    sending.join()
    assert [bytes(frame) for frame in got] == [bytes(frame) for frame in sent]
    assert all(isinstance(frame, memoryview) and frame.readonly for frame in got)


@pytest.mark.parametrize("sent", [b"", b"\x02", b"\x01\0\0\0" + b"\x09\0\0\0\0\0\0\0" + b"short"])
def test_an_end_in_the_middle_is_no_message(pipe: Pipe, sent: bytes) -> None:
    reader, writer = pipe
    writer.write(sent)
    writer.close()
    with pytest.raises(EOFError):
        read_frames(reader)


def test_messages_are_the_same_after_they_are_sent() -> None:
    request = Request(b"environment", b"address", b"[1]", [b"x", b"yz"])
    assert Request.from_frames(request.frames()) == request
    outcome = Outcome(State.FAILED, (), "nö", "trace\n", ("a", "b"), 1.5)
    response = Response(ResponseKind.OUTCOME, outcome, "numpy 1.0", b"[2]", [b"x"])
    assert Response.from_frames(response.frames()) == response


Make = Callable[..., None]


@pytest.fixture
def make(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Make:
    """Write a package of two modules, or one module, and import it."""
    monkeypatch.syspath_prepend(str(tmp_path))

    def write(name: str, text: str, *, helper: str = "") -> None:
        file = tmp_path / f"{name}.py"
        if helper:
            (tmp_path / name).mkdir(exist_ok=True)
            file = tmp_path / name / "__init__.py"
            (tmp_path / name / "helper.py").write_text(helper)
        file.write_text(text)
        if name not in sys.modules:
            monkeypatch.setitem(sys.modules, name, __import__(name))

    return write


def test_an_edit_of_any_file_changes_the_code_of_its_package_alone(make: Make) -> None:
    make("code_a", "x = 1", helper="y = 1")
    make("code_b", "x = 1")
    before = code_of(["code_a", "code_b"])
    make("code_a", "x = 1", helper="y = 2")
    after = code_of(["code_a", "code_b"])
    assert after["code_a"] != before["code_a"]
    assert after["code_b"] == before["code_b"]


def test_the_same_files_have_the_same_code_wherever_they_lie(
    make: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make("code_c", "x = 1", helper="y = 1")
    before = code_of(["code_c"])
    (tmp_path / "code_c").rename(tmp_path / "moved")
    monkeypatch.setattr(sys.modules["code_c"], "__path__", [str(tmp_path / "moved")])
    assert code_of(["code_c"]) == before


def test_what_a_package_imports_is_reached_through_others(make: Make) -> None:
    make("code_d", "x = 1")
    make("code_e", "def late():\n    from code_d import x\n    return x")
    make("code_f", "import code_e")
    make("code_g", "x = 1")
    code = code_of(["code_d", "code_e", "code_f", "code_g"])
    assert reached("code_f", code) == {"code_f", "code_e", "code_d"}
    assert reached("code_g", code) == {"code_g"}
    assert reached("unknown", code) == set()


def test_what_has_no_source_has_no_code() -> None:
    assert code_of(["sys", "no_such_module"]) == {}
