"""One call of one node: what goes in, what came out, or why nothing did."""

from __future__ import annotations

import inspect
import time
import traceback
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError, Refusal
from nodegraph.node.decorator import Node
from nodegraph.node.values import locked
from nodegraph.plan import Gathered, Plan, Step

_WRITES = ("read-only", "readonly", "WRITEABLE", "cannot assign to field")
"""What numpy, numba and frozen dataclasses say when somebody writes to what is locked."""

_heard: ContextVar[list[str] | None] = ContextVar("_heard", default=None)


@dataclass(slots=True)  # frozen, it would take three times as long to make
class Call:
    """Everything that one step needs to be computed, wherever that is.

    Attributes
    ----------
    step : int
        Its index in the plan.
    node : Node
    plugin : str
        Who brought the node.
    inputs : mapping of port to value
    settings : mapping of setting to value
    """

    step: int
    node: Node
    plugin: str
    inputs: Mapping[str, Any]
    settings: Mapping[str, Any]


@dataclass(slots=True)
class Outcome:
    """What became of a step.

    Attributes
    ----------
    state : str
        ``done``, ``refused``, ``failed`` or ``skipped``; ``unneeded`` when stored results made
        it so.
    values : tuple
        One value per output port, when it is done and until the schedule has taken them.
    reason : str
        Why there is no value.
    trace : str
        Where it failed, for its author.
    warnings : tuple of str
        What the node had to say.
    seconds : float
        That it took to compute, now or when it was stored.
    cause : str
        For a skipped step, what became of the one that it needed: ``refused``, ``failed`` or
        ``skipped``; else the state itself.
    stored : bool
        Whether it was found in the store and not computed.
    digests : tuple of str
        One per output port, of its content, when it is in the store.
    place : str
        For a failed step, the line of the node's own file: ``mine.py:12``.
    """

    state: str
    values: tuple[Any, ...] = ()
    reason: str = ""
    trace: str = ""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0
    cause: str = ""
    stored: bool = False
    digests: tuple[str, ...] = ()
    place: str = ""

    @property
    def told(self) -> str:
        """The reason with its place, which stays out of all that results are made of."""
        return f"{self.reason} ({self.place})" if self.place else self.reason


def perform(call: Call) -> Outcome:
    """Call a node; whatever it raises becomes part of the outcome."""
    heard: list[str] = []
    token = _heard.set(heard)
    place = ""
    began = time.perf_counter()
    try:
        values = values_of(call.node, call.node.function(**call.inputs, **call.settings))
    except Refusal as refusal:
        state, values, reason, trace = "refused", (), str(refusal) or "no reason given", ""
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        state, values, reason, trace = "failed", (), _reason(error), _trace(error)
        place = _shown(_place(call.node, error))
    else:
        state, reason, trace = "done", "", ""
    finally:
        _heard.reset(token)
    seconds = time.perf_counter() - began
    said = tuple(dict.fromkeys(map(_shown, heard))) if heard else ()
    return Outcome(state, values, _shown(reason), _shown(trace), said, seconds, state, place=place)


@contextmanager
def warnings_heard() -> Iterator[None]:
    """Let what nodes warn of become part of their step's outcome, in whatever thread they run."""
    with warnings.catch_warnings():
        for category in (UserWarning, RuntimeWarning):
            warnings.simplefilter("always", category)
        show = warnings.showwarning

        def hear(message: Warning | str, category: type[Warning], *rest: Any) -> None:
            heard = _heard.get()
            if heard is None:
                show(message, category, *rest)
            else:
                heard.append(str(message))

        warnings.showwarning = hear  # type: ignore[assignment]
        yield


def values_of(node: Node, returned: Any) -> tuple[Any, ...]:
    """Return one value per output port of what a node's function returned, its arrays locked.

    Raises
    ------
    TypeError
        If it is not what the node's signature promises.
    """
    values = _split(node, returned) if node.splits else (returned,)
    for port, value in zip(node.outputs, values, strict=True):
        if not isinstance(value, port.type):
            raise TypeError(
                f"{node.name} returned {type(value).__name__} where its signature promises "
                f"{port.type.__name__} ({port.name})"
            )
    return tuple(map(locked, values))


def _split(node: Node, returned: Any) -> tuple[Any, ...]:
    names = [port.name for port in node.outputs]
    if not all(hasattr(returned, name) for name in names):
        raise TypeError(
            f"{node.name} returned {type(returned).__name__} where its signature promises "
            f"{', '.join(names)}"
        )
    return tuple(getattr(returned, name) for name in names)


def writes_to_what_is_locked(error: BaseException) -> bool:
    """Whether an error says that somebody wrote to what other nodes read as well."""
    if isinstance(error, (OSError, NodegraphError)):  # a disk may be read-only, too
        return False
    return any(sign in _message(error) for sign in _WRITES)


def _reason(error: BaseException) -> str:
    said = _message(error) or "no message"
    if not isinstance(error, (ValueError, OSError)):
        said = f"{type(error).__name__}: {said}"
    if writes_to_what_is_locked(error):
        return f"it changes its input: copy before you write; {said}"
    return said


def _message(error: BaseException) -> str:
    try:
        return str(error)
    except Exception:
        return "its message cannot be shown"


def _place(node: Node, error: BaseException) -> str:
    """Return the line of the node's own file from which an error came; no path of this machine."""
    code = getattr(inspect.unwrap(node.function), "__code__", None)
    frames = traceback.walk_tb(error.__traceback__)
    own = [line for frame, line in frames if code and frame.f_code.co_filename == code.co_filename]
    return f"{Path(code.co_filename).name}:{own[-1]}" if code and own else ""


def _trace(error: BaseException) -> str:
    return "".join(traceback.format_exception(error))


def _shown(text: str) -> str:
    """Return a text without what cannot be written, such as parts of a file's unreadable name."""
    return text if text.isascii() else text.encode("utf-8", "backslashreplace").decode()


def skipped(plan: Plan, step: Step, outcomes: Mapping[int, Outcome]) -> Outcome | None:
    """Return why a step cannot run, if one that it needs has no value.

    Parameters
    ----------
    plan
    step
    outcomes
        How steps before it ended, as far as that is known. While the reason could still be
        another one there is none, so that it never depends on what was known when.
    """
    for fed in step.inputs.values():
        needed = _undone(fed, outcomes) if isinstance(fed, Gathered) else fed.step
        if needed is None:
            continue
        outcome = outcomes.get(needed)
        if outcome is None:
            return None
        if outcome.state != "done":
            return _because(plan.steps[needed], outcome)
    return None


def _undone(fed: Gathered, outcomes: Mapping[int, Outcome]) -> int | None:
    """Return a step of those gathered, or None if any of them is known to be done."""
    known = [outcomes.get(one.step) for _, one in fed.entries]
    if any(outcome is not None and outcome.state == "done" for outcome in known):
        return None
    return fed.entries[known.index(None) if None in known else 0][1].step


def _because(needed: Step, cause: Outcome) -> Outcome:
    said = (
        cause.reason if cause.state == "skipped" else f"{needed.name} {cause.state}: {cause.reason}"
    )
    return Outcome("skipped", reason=said, cause=cause.cause)
