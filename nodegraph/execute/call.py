"""One call of one node."""

from __future__ import annotations

import os
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from nodegraph.errors import Refusal, message_of, one_line
from nodegraph.execute.call_notes import Notes, notes_of_call
from nodegraph.execute.interruption import is_interruption
from nodegraph.execute.outcome import Outcome, failure
from nodegraph.execute.shared_state import StateBefore
from nodegraph.formatting import printable
from nodegraph.node.decorator import Node
from nodegraph.node.ports import Port
from nodegraph.node.values import locked
from nodegraph.plugin.formats import registry_of_call
from nodegraph.plugin.registry import Registry
from nodegraph.state import State


@dataclass(slots=True, eq=False)  # frozen, it would take three times as long to create
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


def perform(call: Call) -> Outcome:
    """Call a node; whatever it raises becomes part of the outcome."""
    node, registry = call.node, call.registry
    foreign = _foreign(call)
    notes = Notes(node, call.settings, with_reads=foreign is not None)
    # set and reset by hand: a context manager for each step would take three times as long
    noted = notes_of_call.set(notes)
    used = None if registry_of_call.get() is registry else registry_of_call.set(registry)
    start = time.perf_counter()
    _calls.begin()
    if foreign is not None:
        _kept.begin(call)
    try:
        try:
            returned = node.function(**call.inputs, **call.settings)
        finally:
            if os.getpid() != notes.process:
                os._exit(0)  # it has forked: the run goes on in the other process alone
            if foreign is not None:
                notes.warnings += _kept.put_back(call)
            notes.warnings += _calls.end()
        values = values_of(node, returned)
        notes.check_threads()
        notes.warnings += _broken_promises(call, values, foreign)
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


def _foreign(call: Call) -> Registry | None:
    """Return the plugins of the run where the node is none of this package's own."""
    registry = call.registry
    return None if registry is None or call.plugin in registry.shipped else registry


def _broken_promises(
    call: Call, values: Sequence[object], foreign: Registry | None
) -> Iterator[str]:
    """Yield what a third party's node breaks of its family's promises, as far as a call shows."""
    if foreign is None:
        return
    node = call.node
    outputs = {port.name: value for port, value in zip(node.outputs, values, strict=True)}
    for promise, where in foreign.hooks.broken_promises(node, call.inputs, outputs, call.settings):
        yield f"{where} (every {node.family}.* node promises: {promise})"


def timed_out(call: Call) -> Outcome:
    """Return the outcome of a call that has taken longer than it may."""
    seconds = call.timeout or 0.0
    reason = f"it takes longer than {seconds:g} s, which is the limit"
    changed = tuple(_kept.put_back(call))
    return Outcome(State.FAILED, reason=reason, warnings=changed, seconds=seconds, key=call.key)


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
        _kept.forget()
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

    def end(self) -> Sequence[str]:
        """Return a warning if warnings would no longer be collected."""
        with self._lock:
            self._count -= 1
            if self._count or self.collect is None or self._are_collected():
                return ()
            self.collect_again()
        return (
            "it changes the filters of warnings, which are put back: put `with "
            "warnings.catch_warnings():` around the line",
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
_kept = StateBefore()


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
