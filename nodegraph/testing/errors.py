"""Whether what a node raises tells its user what is wrong with the data, or is a fault."""

from __future__ import annotations

import linecache
import traceback
from pathlib import Path
from types import FrameType

from nodegraph.errors import NodegraphError
from nodegraph.testing.parts import oddities
from nodegraph.values import Value

_LIBRARIES = {"numpy", "scipy", "pandas", "sklearn", "numba", "pywt", "matplotlib", "networkx"}
_INSTEAD = (
    'raise nodegraph.Refusal("what it needs") where this data cannot be done, or ValueError '
    "with the place and what is wrong"
)


def fault_of(error: BaseException, given: object) -> str:
    """Return what is wrong with raising this; an empty text where it declines in clear words.

    A node declines by `nodegraph.NodegraphError`, which a refusal is, or by a ValueError that
    somebody raised on purpose: not by one that a library lets out of its inside, nor by one that
    says that the node's own answer cannot be.

    Parameters
    ----------
    error
    given
        What the node was given.
    """
    if isinstance(error, NodegraphError):
        return ""
    if not isinstance(error, ValueError):
        return f"raises {type(error).__name__} on odd data: handle it, {_INSTEAD}"
    if odd := oddities(_value_in_making(error)) - oddities(given):
        return (
            f"makes numbers that are {' and '.join(sorted(odd))}, out of such as are not: find "
            f"where it divides by zero or overflows, or {_INSTEAD}"
        )
    if library := _library(error):
        return f"lets an error of {library} out, which tells no user what to mend: {_INSTEAD}"
    return ""


def told(error: BaseException) -> str:
    """Return an error with the file and line that raised it.

    Parameters
    ----------
    error
        One that was raised.
    """
    last = traceback.extract_tb(error.__traceback__)[-1]
    said = str(error) or "no message"
    return f"{type(error).__name__}: {said} ({Path(last.filename).name}:{last.lineno})"


def _value_in_making(error: BaseException) -> Value | None:
    """Return the value that was being made when the error was raised, if one was."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        made = frame.f_locals.get("self")
        if frame.f_code.co_name == "__post_init__" and isinstance(made, Value):
            return made
    return None


def _library(error: BaseException) -> str:
    """Return who raised an error that nobody raised on purpose in readable Python."""
    *_, (frame, line) = traceback.walk_tb(error.__traceback__)
    package = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    if package in _LIBRARIES:
        return package
    return "" if _raises(frame, line) else "a library, or of Python,"


def _raises(frame: FrameType, line: int) -> bool:
    """Whether a line is a ``raise``; also where it cannot be read."""
    text = linecache.getline(frame.f_code.co_filename, line, frame.f_globals).strip()
    return not text or "raise" in text.split("#")[0]
