"""One call of one node: what goes in, what came out, or why nothing did."""

from __future__ import annotations

import time
import traceback
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from nodegraph.errors import Refusal
from nodegraph.node import Node
from nodegraph.values import locked

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


def perform(call: Call) -> Outcome:
    """Call a node; whatever it raises becomes part of the outcome."""
    heard: list[str] = []
    token = _heard.set(heard)
    began = time.perf_counter()
    try:
        values = values_of(call.node, call.node.function(**call.inputs, **call.settings))
    except Refusal as refusal:
        state, values, reason, trace = "refused", (), str(refusal) or "no reason given", ""
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        state, values, reason, trace = "failed", (), _reason(error), _trace(error)
    else:
        state, reason, trace = "done", "", ""
    finally:
        _heard.reset(token)
    seconds = time.perf_counter() - began
    said = tuple(dict.fromkeys(map(_shown, heard))) if heard else ()
    return Outcome(state, values, _shown(reason), _shown(trace), said, seconds, state)


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


def _reason(error: BaseException) -> str:
    try:
        said = str(error) or "no message"
    except Exception:
        said = "its message cannot be shown"
    return said if isinstance(error, (ValueError, OSError)) else f"{type(error).__name__}: {said}"


def _trace(error: BaseException) -> str:
    return "".join(traceback.format_exception(error))


def _shown(text: str) -> str:
    """Return a text without what cannot be written, such as parts of a file's unreadable name."""
    return text if text.isascii() else text.encode("utf-8", "backslashreplace").decode()
