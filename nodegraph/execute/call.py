"""One call of one node: what goes in, and the outcome: values, or why there are none."""

from __future__ import annotations

import inspect
import os
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import Any

from nodegraph.cache_key import PARSER
from nodegraph.errors import NodegraphError, Refusal, message_of, one_line, without_middle
from nodegraph.execute.call_notes import Notes, notes_of_call
from nodegraph.execute.interruption import is_interruption
from nodegraph.execute.shared_state import Kept
from nodegraph.formatting import printable
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port
from nodegraph.node.values import locked
from nodegraph.plan import Gathered, Plan, Step
from nodegraph.plugin.formats import registry_of_call
from nodegraph.plugin.registry import Registry
from nodegraph.state import State

_READ_ONLY = ("read-only", "readonly", "WRITEABLE", "cannot assign to field")
"""Beginnings of the errors of numpy, numba and frozen dataclasses on writing to a locked value."""

_LONGEST_TRACE = 20_000
"""Characters of a traceback that a run keeps; its message may quote a whole array."""


@dataclass(slots=True)  # not frozen, which would make it three times as slow to create
class Call:
    """Everything that one step needs to be computed, in this process or another.

    Attributes
    ----------
    step : int
        Its index in the plan.
    node : Node
    plugin : str
        Name of the plugin that defines the node.
    inputs : mapping of port to value
    settings : mapping of setting to value
    key : str
        Under which the result is stored; empty if it cannot be.
    registry : Registry or None
        The plugins of the run, if the node is to read the formats of their files.
    timeout : float or None
        Seconds that it may take: the limit of the run or of the node, whichever is shorter.
    """

    step: int
    node: Node
    plugin: str
    inputs: Mapping[str, object]
    settings: Mapping[str, object]
    key: str = ""
    registry: Registry | None = None
    timeout: float | None = None


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


def perform(call: Call) -> Outcome:
    """Call a node; whatever it raises becomes part of the outcome."""
    node, registry = call.node, call.registry
    is_ours = registry is None or call.plugin in registry.shipped
    notes = Notes(node, call.settings, with_reads=not is_ours)
    # set and reset by hand: a context manager for each step would take three times as long
    noted = notes_of_call.set(notes)
    used = None if registry_of_call.get() is registry else registry_of_call.set(registry)
    start = time.perf_counter()
    _calls.begin()
    if not is_ours:
        _kept.begin(call)
    try:
        try:
            returned = node.function(**call.inputs, **call.settings)
        finally:
            if os.getpid() != notes.process:
                os._exit(0)  # it has forked: the run goes on in the other process alone
            if not is_ours:
                notes.warnings += _kept.put_back(call)
            notes.warnings += _calls.end()
        values = values_of(node, returned)
        notes.check_threads()
        outcome = Outcome(State.DONE, values)
    except Refusal as refusal:
        reason = printable(message_of(refusal)) or "no reason given"
        outcome = Outcome(State.REFUSED, reason=reason)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and is_interruption(error):
            raise
        outcome = failure(node, error)
    finally:
        notes_of_call.reset(noted)
        if used is not None:
            registry_of_call.reset(used)
    outcome.seconds = time.perf_counter() - start
    if notes.reads:
        outcome.undeclared_reads = tuple(map(printable, notes.reads))
    if notes.warnings:
        outcome.warnings = tuple(
            dict.fromkeys(one_line(printable(text)) for text in notes.warnings)
        )
    return outcome


def timed_out(call: Call) -> Outcome:
    """Return the outcome of a call that has taken longer than it may."""
    seconds = call.timeout or 0.0
    reason = f"it takes longer than {seconds:g} s, which is the limit"
    changed = tuple(_kept.put_back(call))
    return Outcome(State.FAILED, reason=reason, warnings=changed, seconds=seconds, key=call.key)


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
    with PARSER:
        trace = "".join(traceback.format_exception(error))
    return Outcome(
        State.FAILED,
        reason=one_line(printable(reason)),
        trace=without_middle(printable(trace), _LONGEST_TRACE),
        place=printable(place),
    )


_COLLECTED = (UserWarning, RuntimeWarning)


@contextmanager
def collecting_warnings() -> Iterator[None]:
    """Make what nodes warn of part of their step's outcome, whatever thread they run in."""
    with warnings.catch_warnings():
        show = warnings.showwarning

        def collect(message: Warning | str, category: type[Warning], *rest: Any) -> None:
            notes = notes_of_call.get()
            if notes is None:
                show(message, category, *rest)
            else:
                notes.warnings.append(str(message))

        outer, _calls.collect = _calls.collect, collect
        _calls.collect_again()
        try:
            yield
        finally:
            _calls.collect = outer


class _Calls:
    """The calls that are being made in this process, and what collects their warnings.

    Filters of warnings belong to the whole process, and calls change them for a moment: they are
    looked at when no call is being made.
    """

    def __init__(self) -> None:
        self.collect: Callable[..., None] | None = None
        self._filters: list[Any] = []  # of warnings, with which they were collected
        self._lock = threading.Lock()
        self._count = 0

    def begin(self) -> None:
        with self._lock:
            self._count += 1

    def end(self) -> Iterator[str]:
        """Yield a warning if warnings would no longer be collected."""
        with self._lock:
            self._count -= 1
            if not self._count and self.collect is not None and not self._are_collected():
                self.collect_again()
                yield (
                    "it changes the filters of warnings, which are put back: put `with "
                    "warnings.catch_warnings():` around the line"
                )

    def collect_again(self) -> None:
        for category in _COLLECTED:
            warnings.simplefilter("always", category)
        warnings.showwarning = self.collect  # type: ignore[assignment]
        self._filters = [*warnings.filters]

    def _are_collected(self) -> bool:
        filters = warnings.filters
        if filters != self._filters and all(
            next((each[0] for each in filters if _is_for_all(each, category)), "") == "always"
            for category in _COLLECTED
        ):
            self._filters = [*filters]
        return warnings.showwarning is self.collect and filters == self._filters


def _is_for_all(filtered: Any, category: type[Warning]) -> bool:
    """Whether a filter applies to every warning of a category, whatever its text and module."""
    _, message, kind, module, _ = filtered
    return message is None and module is None and issubclass(category, kind)


_calls = _Calls()
_kept = Kept()


def values_of(node: Node, returned: object) -> tuple[Any, ...]:
    """Return one value per output port of what a node's function returned, its arrays locked.

    Raises
    ------
    TypeError
        If it is not what the node's signature promises.
    """
    if not node.splits:
        return (_locked(node, node.outputs[0], returned),)
    names = [port.name for port in node.outputs]
    if not all(hasattr(returned, name) for name in names):
        raise TypeError(
            f"{node.name} returned {type(returned).__name__} where its signature promises "
            f"{', '.join(names)}"
        )
    return tuple(_locked(node, port, getattr(returned, port.name)) for port in node.outputs)


def _locked(node: Node, port: Port, value: object) -> object:
    if not isinstance(value, port.type):
        raise TypeError(
            f"{node.name} returned {type(value).__name__} where its signature promises "
            f"{port.type.__name__} ({port.name})"
        )
    return locked(value)


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
        needed = _missing(source, outcomes) if isinstance(source, Gathered) else source.step
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


def _missing(source: Gathered, outcomes: Mapping[int, Outcome]) -> int | None:
    """Return a gathered step without a value, or None if any of them is known to be done."""
    known = [outcomes.get(output.step) for _, output in source.entries]
    if any(outcome is not None and outcome.state is State.DONE for outcome in known):
        return None
    return source.entries[known.index(None) if None in known else 0][1].step
