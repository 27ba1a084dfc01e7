"""What runs inside a Dask worker: one question answered, its buffers as arrays of bytes."""

from __future__ import annotations

from typing import Any

import numpy as np
from distributed import get_worker

from nodegraph.execute.elsewhere.answering import answer
from nodegraph.execute.elsewhere.frames import Frame
from nodegraph.execute.elsewhere.letters import Question
from nodegraph.execute.one_thread import one_thread_here

Sent = tuple[Any, ...]
"""The worker's address, then the frames of the answer; large ones as arrays of bytes."""


def work(*frames: Any) -> Sent:
    """Answer a question, given as its frames."""
    question = Question.from_frames([as_frame(one) for one in frames])
    with one_thread_here():
        said, head, *buffers = answer(question).frames()
    return get_worker().address, said, head, *map(as_bytes_array, buffers)


def as_bytes_array(buffer: Frame) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return bytes as what Dask sends as they lie."""
    return np.frombuffer(buffer, np.uint8) if len(buffer) else np.empty(0, np.uint8)


def as_frame(sent: Any) -> Frame:
    """Return what `as_bytes_array` made an array of."""
    return sent.data.toreadonly() if isinstance(sent, np.ndarray) else bytes(sent)
