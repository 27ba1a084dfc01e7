from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from io import BufferedReader, BufferedWriter

import numpy as np
import pytest

from nodegraph.execute.call import Outcome
from nodegraph.execute.worker.protocol import (
    Request,
    Response,
    ResponseKind,
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
