"""Here: calls as questions to other processes, and what their answers come to."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import warnings
from contextlib import suppress
from dataclasses import replace
from io import BufferedReader, BufferedWriter
from typing import cast

from nodegraph.errors import NodegraphError
from nodegraph.execute.call import Call, Outcome
from nodegraph.execute.schedule import Schedule
from nodegraph.execute.worker.protocol import (
    INTERRUPTED,
    LACKING,
    NOT_SENT,
    Address,
    Answer,
    Question,
    Surroundings,
    read_frames,
    write_frames,
)
from nodegraph.store import Unreadable, Unstorable


class Asker:
    """Turns calls into questions, and answers into outcomes.

    Parameters
    ----------
    schedule
    shares_files
        Whether those who answer see the same files as this process.
    are_new
        Whether they are started for these calls, and so have the code that there is now.
    """

    def __init__(self, schedule: Schedule, *, shares_files: bool, are_new: bool) -> None:
        self._packer = schedule.packer
        self._registry = schedule.plan.graph.registry
        self._shares_files = shares_files
        surroundings = Surroundings.of(self._registry, with_code=not are_new)
        self._surroundings = surroundings.as_bytes()
        self._addresses: dict[int, bytes | None] = {}
        self._told: set[str] = set()

    def question(self, call: Call) -> Question | None:
        """Return a call as a question, or None if it must be made here."""
        address = self._address(call)
        if address is None or self._reads_files(call):
            return None
        try:
            packed = self._packer.pack((dict(call.inputs), dict(call.settings)))
        except Unstorable:
            return None
        if not packed.faithful:
            return None
        return Question(self._surroundings, address, packed.head.encode(), packed.buffers)

    def outcome(self, answer: Answer, who: str) -> Outcome | None:
        """Return what an answer comes to, or None if the call must be made here.

        Parameters
        ----------
        answer
        who
            Who has answered, for what is told to the user.
        """
        if answer.kind == INTERRUPTED:
            raise KeyboardInterrupt
        if answer.kind == NOT_SENT:
            return None
        if answer.differs and answer.differs not in self._told:
            self._told.add(answer.differs)
            warnings.warn(
                f"{who} has {answer.differs}: results may differ in their last digits",
                stacklevel=2,
            )
        if answer.kind == LACKING:
            return replace(answer.outcome, reason=f"{who} {answer.outcome.reason}")
        try:
            values = self._packer.unpack(answer.head.decode(), answer.buffers)
        except Unreadable:
            return None
        return replace(answer.outcome, values=values)

    def _address(self, call: Call) -> bytes | None:
        # by identity: the plan keeps the nodes, and comparing them would read their signatures
        known = id(call.node)
        if known not in self._addresses:
            self._addresses[known] = self._new_address(call)
        return self._addresses[known]

    def _new_address(self, call: Call) -> bytes | None:
        address = Address.of(call, self._registry)
        ports = (*call.node.inputs, *call.node.outputs)
        if address is None or not all(self._packer.travels(port.type) for port in ports):
            return None
        return address.as_bytes()

    def _reads_files(self, call: Call) -> bool:
        return not self._shares_files and any(
            setting.is_file and call.settings.get(name) is not None
            for name, setting in call.node.settings.items()
        )


_START = (
    "import json, sys, importlib; "
    "module, sys.path[:] = json.loads(sys.argv.pop(1)); "
    "importlib.import_module(module).main()"
)


def start(module: str, *words: str, answers: bool = False) -> subprocess.Popen[bytes]:
    """Start ``module.main()`` in another process, which finds modules where this one does.

    Its standard input is a pipe, whose end tells it to end. It is not in the foreground of the
    terminal: Ctrl-C reaches this process alone.

    Parameters
    ----------
    module
    *words
        Its ``sys.argv[1:]``.
    answers
        Whether its standard output is a pipe, too.
    """
    return subprocess.Popen(
        [
            sys.executable,
            "-P",
            "-c",
            _START,
            json.dumps([module, list(map(str, sys.path))]),
            *words,
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE if answers else None,
        start_new_session=True,
    )


def kill(process: subprocess.Popen[bytes]) -> None:
    """End a program, and what it has started itself, at once."""
    if process.returncode is not None:
        return  # its number may be another's by now
    with suppress(ProcessLookupError):
        if sys.platform == "win32":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGKILL)


def how_it_ended(process: subprocess.Popen[bytes]) -> str:
    """Return how a program ended that has closed its pipes."""
    try:
        status = process.wait(timeout=5)
    except subprocess.TimeoutExpired:  # it has not ended, but nobody can talk to it any more
        kill(process)
        process.wait()
        return "closed its pipes"
    if status >= 0:
        return f"ended with exit status {status}"
    number = -status
    name = signal.Signals(number).name if number in set(signal.Signals) else str(number)
    hint = " (out of memory?)" if name == "SIGKILL" else ""
    return f"was ended by signal {name}{hint}"


_LONG_ENOUGH = 5.0
"""Seconds that a worker has to end by itself."""


class EndedError(Exception):
    """The worker has ended instead of answering; the text says how."""


class Child:
    """A worker process. It starts at once, and is ready when it first answers."""

    def __init__(self) -> None:
        self._process = start("nodegraph.execute.worker.server", answers=True)
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
            how = how_it_ended(self._process)
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
        kill(self._process)
        self._process.wait()

    def _close_pipes(self) -> None:
        for pipe in (self._requests, self._replies):
            with suppress(OSError):  # what it did not read any more
                pipe.close()
