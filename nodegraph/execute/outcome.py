"""The outcome of a step: its values, or why there are none."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError, message_of, one_line, without_middle
from nodegraph.formatting import printable
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Across
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.plan import Output, Plan, Step

_READ_ONLY = ("read-only", "readonly", "WRITEABLE", "cannot assign to field")
"""Beginnings of the errors of numpy, numba and frozen dataclasses on writing to a locked value."""

_LONGEST_TRACE = 20_000
"""Characters of a traceback that a run keeps; its message may quote a whole array."""


@dataclass(slots=True)
class Outcome:
    """The outcome of a step.

    Attributes
    ----------
    state : State
    values : tuple
        One per output port, if the step is done and until the schedule has taken them.
    reason : str
        Why there is no value.
    trace : str
        Traceback of a failure.
    warnings : tuple of str
        Warnings of the node.
    seconds : float
        Duration of the computation, now or when it was stored.
    cause : State or None
        For a skipped step, how the step ended without which it cannot run.
    stored : bool
        Whether it was found in the store and not computed.
    digests : tuple of str
        One per output port, of its content, if it is in the store.
    place : str
        For a failed step, the line of the node's own file: ``mine.py:12``.
    key : str
        Under which the result is stored, or would be; empty if it cannot be.
    undeclared_reads : tuple of str
        Files and variables that the node read and that are not in its key: names of files,
        ``$VARIABLE``.
    """

    state: State
    values: tuple[Any, ...] = ()
    reason: str = ""
    trace: str = ""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0
    cause: State | None = None
    stored: bool = False
    digests: tuple[str, ...] = ()
    place: str = ""
    key: str = ""
    undeclared_reads: tuple[str, ...] = ()

    @property
    def status(self) -> State:
        """The state as events and counts list it: ``stored`` if it is done without a call."""
        return State.STORED if self.stored and self.state is State.DONE else self.state

    @property
    def root(self) -> State:
        """The state of the step that this goes back to, which is this one unless it is skipped."""
        return self.cause or self.state

    @property
    def message(self) -> str:
        """The reason with its place, which is no part of what is stored or compared."""
        return f"{self.reason} ({self.place})" if self.place else self.reason


def failure(node: Node, error: BaseException, what: str = "") -> Outcome:
    """Return the outcome of a step that failed.

    Parameters
    ----------
    node
    error
    what
        The action that failed, if it was not the call of the node.
    """
    reason, place = _reason(error), _place(node, error)
    if what:
        reason, place = f"{what}: {reason}", place or _definition(node)
    trace = "".join(traceback.format_exception(error))
    return Outcome(
        State.FAILED,
        reason=one_line(printable(reason)),
        trace=without_middle(printable(trace), _LONGEST_TRACE),
        place=printable(place),
    )


def writes_to_locked_value(error: BaseException) -> bool:
    """Whether an error says that a value was written to that other nodes read as well."""
    if isinstance(error, (OSError, NodegraphError)):  # a disk may be read-only, too
        return False
    return any(sign in message_of(error) for sign in _READ_ONLY)


def _reason(error: BaseException) -> str:
    is_full = isinstance(error, MemoryError)  # which says nothing, raised by Python itself
    reason = message_of(error) or ("more memory than it may have" if is_full else "no message")
    if not isinstance(error, (ValueError, OSError)):
        reason = f"{type(error).__name__}: {reason}"
    if writes_to_locked_value(error):
        return f"it modifies its input; copy it before writing: {reason}"
    return reason


def _place(node: Node, error: BaseException) -> str:
    """Return the line of the node's own file from which an error came; no path of this machine."""
    code = _code(node)
    frames = traceback.walk_tb(error.__traceback__)
    own = [line for frame, line in frames if code and frame.f_code.co_filename == code.co_filename]
    return f"{Path(code.co_filename).name}:{own[-1]}" if code and own else ""


def _definition(node: Node) -> str:
    code = _code(node)
    return f"{Path(code.co_filename).name}:{code.co_firstlineno}" if code else ""


def _code(node: Node) -> CodeType | None:
    return getattr(inspect.unwrap(node.function), "__code__", None)


def skipped(plan: Plan, step: Step, outcomes: Mapping[int, Outcome]) -> Outcome | None:
    """Return the outcome of a step that cannot run because one that it needs has no value.

    Parameters
    ----------
    plan
    step
    outcomes
        How steps before it ended, as far as that is known. While the reason could still be
        another one, None is returned, so that it never depends on the order of execution.
    """
    for source in step.inputs.values():
        needed = _missing(source, outcomes) if isinstance(source, Across) else source.step
        if needed is None:
            continue
        outcome = outcomes.get(needed)
        if outcome is None:
            return None
        if outcome.state is not State.DONE:
            reason = outcome.reason
            if outcome.state is not State.SKIPPED:
                reason = f"{plan.steps[needed].name} {outcome.state}: {reason}"
            return Outcome(State.SKIPPED, reason=reason, cause=outcome.root)
    return None


def _missing(source: Across[Output], outcomes: Mapping[int, Outcome]) -> int | None:
    """Return a gathered step without a value, or None if any of them is known to be done."""
    known = [outcomes.get(output.step) for _, output in source.entries]
    if any(outcome is not None and outcome.state is State.DONE for outcome in known):
        return None
    return source.entries[known.index(None) if None in known else 0][1].step
