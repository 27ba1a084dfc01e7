"""In the other process: one question answered."""

from __future__ import annotations

from dataclasses import replace

from nodegraph.execute.call import Call, Outcome, perform, warnings_heard
from nodegraph.execute.elsewhere.finding import Finder, LackingError, finder_in
from nodegraph.execute.elsewhere.letters import (
    INTERRUPTED,
    LACKING,
    NOT_SENT,
    OUTCOME,
    Answer,
    Question,
)
from nodegraph.execute.one_thread import one_thread_each
from nodegraph.execute.while_any import WhileAny
from nodegraph.store import Unreadable, Unstorable


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
    return Answer(kind, Outcome("failed", reason=reason, cause="failed"))


_at_work = WhileAny(warnings_heard, one_thread_each)
