"""A worker process, as the process sees it that asks it."""

from __future__ import annotations

import subprocess
from contextlib import suppress
from io import BufferedReader, BufferedWriter
from typing import cast

from nodegraph.errors import NodegraphError
from nodegraph.execute.elsewhere import programs
from nodegraph.execute.elsewhere.frames import read_frames, write_frames
from nodegraph.execute.elsewhere.letters import Answer, Question

_LONG_ENOUGH = 5.0
"""Seconds that a worker has to end by itself."""


class EndedError(Exception):
    """The worker has ended instead of answering; the text says how."""


class Child:
    """A worker process. It starts at once, and is ready when it first answers."""

    def __init__(self) -> None:
        self._process = programs.start("nodegraph.execute.elsewhere.worker", answers=True)
        self._requests = cast(BufferedWriter, self._process.stdin)
        self._replies = cast(BufferedReader, self._process.stdout)
        self._is_ready = False

    @property
    def is_alive(self) -> bool:
        """Whether it can be asked."""
        return self._process.poll() is None

    def ask(self, question: Question) -> Answer:
        """Send a question and wait for the answer.

        Raises
        ------
        EndedError
            If the worker ends first.
        NodegraphError
            If it could not even start.
        """
        try:
            # each side reads all of a message before it writes, so that neither waits for ever
            write_frames(self._requests, question.frames())
            if not self._is_ready:
                self._is_ready = bool(read_frames(self._replies))
            return Answer.from_frames(read_frames(self._replies))
        except (EOFError, OSError) as error:
            how = programs.how_it_ended(self._process)
            if not self._is_ready:
                raise NodegraphError(f"a worker process does not start: it {how}") from error
            raise EndedError(how) from error

    def close(self) -> None:
        """Let it end, with what it has to do at its end."""
        self._close_pipes()
        try:
            self._process.wait(_LONG_ENOUGH)
        except subprocess.TimeoutExpired:
            self.kill()

    def kill(self) -> None:
        """End it at once; from any thread."""
        programs.kill(self._process)
        self._process.wait()

    def _close_pipes(self) -> None:
        for pipe in (self._requests, self._replies):
            with suppress(OSError):  # what it did not read any more
                pipe.close()
