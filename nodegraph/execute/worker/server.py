"""The program of a worker process: answers one question after the other until its input ends."""

from __future__ import annotations

import importlib
import os
import signal
import sys
import threading
import warnings
from dataclasses import replace
from io import BufferedReader, BufferedWriter
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from nodegraph.errors import NodegraphError, UnknownNodeError
from nodegraph.execute.call import Call, Outcome, collecting_warnings, perform
from nodegraph.execute.numeric_threads import WhileAny, one_thread_each
from nodegraph.execute.worker.protocol import (
    INTERRUPTED,
    LACKING,
    NOT_SENT,
    OUTCOME,
    Address,
    Answer,
    Package,
    Question,
    Surroundings,
    code_of,
    reached,
    read_frames,
    write_frames,
)
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin.registry import Registered, Registry
from nodegraph.state import State
from nodegraph.store import Packer, Unreadable, Unstorable

_one_at_a_time = threading.RLock()
_finders: dict[bytes, Finder] = {}
_from_files: set[str] = set()
_imported_code: dict[str, Package] = {}
"""As it was when this process began to answer: later edits of files do not reach it."""


class LackingError(NodegraphError):
    """What a question asks for is not here; the text says what this process "has" or "lacks"."""


def finder_in(surroundings: bytes) -> Finder:
    """Return what finds nodes in these surroundings, made once for each."""
    with _one_at_a_time:  # threads that compute here would import one plugin twice
        found = _finders.get(surroundings)
        if found is None:
            asking = Surroundings.from_bytes(surroundings)
            _forget_files(asking)
            found = _finders[surroundings] = Finder(asking)
        return found


def _forget_files(asking: Surroundings) -> None:
    """Let plugin files be imported anew: those of the same names may have been others."""
    names = {Path(path).stem for path, _ in asking.files}
    if names & _from_files:
        for name in names & _from_files:
            sys.modules.pop(name, None)
        _finders.clear()  # they would take the new classes for their own
    _from_files.update(names)


class Finder:
    """Finds nodes among the installed plugins, and in the files that came along.

    Attributes
    ----------
    packer : Packer
    differs : str
        Which versions are others here than where the question came from.
    """

    def __init__(self, asking: Surroundings) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # who asks has been told of plugins that are broken
            self._registry = Registry.installed(asking.placed())
        self._known: dict[bytes, Node] = {}
        # who asks could name any module as a node's: values may do so, too
        self.packer = Packer(self._registry.hooks.storages, lambda package: True)
        self.differs = "; ".join(asking.differences(Surroundings()))
        self._code = asking.code
        for package, code in code_of(asking.code).items():
            _imported_code.setdefault(package, code)

    def find(self, address: bytes) -> Node:
        """Return the node at an address.

        Raises
        ------
        LackingError
            If it is not here, or comes from another version.
        """
        found = self._known.get(address)
        if found is None:
            with _one_at_a_time:
                found = self._known[address] = self._find(Address.from_bytes(address))
        return found

    def _find(self, wanted: Address) -> Node:
        try:
            found = self._registry.find(f"{wanted.plugin}:{wanted.node}")
        except UnknownNodeError:
            return self._imported(wanted)
        _check_version(found, wanted)
        self._check_code(found.node, wanted)
        return found.node

    def _check_code(self, node: Node, wanted: Address) -> None:
        for package in reached(node.function.__module__.partition(".")[0], self._code):
            here = _imported_code.get(package)
            if here is not None and here[0] != self._code[package][0]:
                raise LackingError(
                    f"has other code of {package} than here, for {wanted.node}; "
                    "install the same there, and start its workers anew"
                )

    def _imported(self, wanted: Address) -> Node:
        try:
            found: Any = importlib.import_module(wanted.module)
            for part in wanted.qualname.split("."):
                found = getattr(found, part)
        except (Exception, SystemExit) as error:
            raise LackingError(self._lacks(wanted)) from error
        node = node_of(found)
        if node is None or node.name != wanted.node:
            raise LackingError(self._lacks(wanted))
        return node

    def _lacks(self, wanted: Address) -> str:
        for one in self._registry.broken:
            if one.name == wanted.plugin:
                left_out = f"has left out the plugin {one.name!r}, which brings {wanted.node}"
                return f"{left_out}: {one.reason}"
        versions = {one.name: one.distribution for one in self._registry.loaded}
        there = versions.get(wanted.plugin)
        if there is None:
            install = f" ({wanted.distribution})" if wanted.distribution else ""
            lacks = f"has no plugin {wanted.plugin!r}, which brings {wanted.node}"
            return f"{lacks}; install it there{install}"
        others = f" (it has {there}, here it is {wanted.distribution})" if there else ""
        return f"has no node {wanted.node} in its plugin {wanted.plugin!r}{others}"


def _check_version(found: Registered, wanted: Address) -> None:
    if found.distribution != wanted.distribution:
        there, here = (one.distribution or "a file" for one in (found, wanted))
        raise LackingError(f"has {there}, here it is {here}, for {wanted.node}")


def answer(question: Question) -> Answer:
    """Find the node, call it, and return what became of it."""
    try:
        finder = finder_in(question.surroundings)
    except Exception as error:  # a file that came along does not import here
        return _without_values(LACKING, f"cannot use what came along: {error}")
    return replace(_answer(finder, question), differs=finder.differs)


def _answer(finder: Finder, question: Question) -> Answer:
    try:
        node = finder.find(question.address)
        inputs, settings = finder.packer.unpack(question.head.decode(), question.buffers)
    except LackingError as error:
        return _without_values(LACKING, str(error))
    except Unreadable as error:
        return _without_values(NOT_SENT, str(error))
    try:
        with _at_work.on():
            outcome = perform(Call(0, node, "", inputs, settings))
    except KeyboardInterrupt:
        return _without_values(INTERRUPTED, "")
    return _packed(finder, outcome)


def _packed(finder: Finder, outcome: Outcome) -> Answer:
    try:
        packed = finder.packer.pack(outcome.values)
    except Unstorable as error:
        return _without_values(NOT_SENT, str(error))
    if not packed.faithful:
        return _without_values(NOT_SENT, "what would come back is a stand-in")
    said = replace(outcome, values=())
    return Answer(OUTCOME, said, head=packed.head.encode(), buffers=packed.buffers)


def _without_values(kind: str, reason: str) -> Answer:
    return Answer(kind, Outcome(State.FAILED, reason=reason))


_at_work = WhileAny(collecting_warnings, one_thread_each)


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
