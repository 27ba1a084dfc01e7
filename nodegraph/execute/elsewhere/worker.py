"""The program of a worker process: answers one question after the other until its input ends."""

from __future__ import annotations

import os
import signal
import sys
import threading
from io import BufferedReader, BufferedWriter
from queue import SimpleQueue

from nodegraph.execute.elsewhere.answering import answer
from nodegraph.execute.elsewhere.frames import read_frames, write_frames
from nodegraph.execute.elsewhere.letters import Question
from nodegraph.execute.one_thread import one_thread_each


def main() -> None:
    """Answer questions from standard input on standard output."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    requests, replies = _pipes()
    write_frames(replies, [b"ready"])
    work = _Work(requests)
    threading.Thread(target=work.read, daemon=True).start()
    with one_thread_each():
        while (question := work.next()) is not None:
            frames = answer(question).frames()
            sys.stdout.flush()
            work.answering = False
            write_frames(replies, frames)
            del question, frames


class _Work:
    """Questions as they come in, and whether one is being answered."""

    def __init__(self, requests: BufferedReader) -> None:
        self._requests = requests
        self._questions: SimpleQueue[Question | None] = SimpleQueue()
        self.answering = False

    def next(self) -> Question | None:
        """Return the next question, or None when there will be none."""
        return self._questions.get()

    def read(self) -> None:
        """Read questions; when whoever asks is gone, nobody waits for the answer either."""
        while True:
            try:
                question = Question.from_frames(read_frames(self._requests))
            except (EOFError, OSError):
                break
            self.answering = True
            self._questions.put(question)
            del question
        if self.answering:
            os._exit(1)
        self._questions.put(None)


def _pipes() -> tuple[BufferedReader, BufferedWriter]:
    """Take the pipes away from standard input and output: what a node prints is no answer."""
    requests, replies = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    os.dup2(2, 1)
    return requests, replies
