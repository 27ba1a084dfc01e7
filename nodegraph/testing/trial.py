"""One node called on one specimen: what it did to its inputs, to chance and to its answer."""

from __future__ import annotations

import copy
import linecache
import traceback
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodegraph.equality import difference
from nodegraph.errors import NodegraphError
from nodegraph.execute.call import values_of, writes_to_locked_value
from nodegraph.node.decorator import Node
from nodegraph.node.values import Value
from nodegraph.testing.surroundings import surroundings


class Faults:
    """Collects faults, so that all of them are told at once."""

    def __init__(self) -> None:
        self._found: dict[str, list[tuple[str, str]]] = {}

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, fault: str, *, specimen: str = "", detail: str = "") -> None:
        """Note a fault: what is wrong and what to change, where it shows, and how.

        Parameters
        ----------
        fault
            What is wrong, and what to change.
        specimen
            On which it shows.
        detail
            How it shows there.
        """
        self._found.setdefault(fault, []).append((specimen, detail))

    def text(self) -> str:
        """Return a line per fault."""
        return "\n".join(f"- {fault}{_shown(seen)}" for fault, seen in self._found.items())


def _shown(seen: list[tuple[str, str]]) -> str:
    specimen = seen[0][0]
    details = dict.fromkeys(detail for one, detail in seen if one == specimen and detail)
    where = f"on {specimen!r}" if specimen else ""
    told = ": ".join(part for part in (where, "; ".join(details)) if part)
    others = list(dict.fromkeys(repr(one) for one, _ in seen[1:] if one != specimen))
    more = f"; also on {', '.join(others)}" if others else ""
    return f"\n    {told}{more}" if told else ""


def arrays(value: Any, name: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """Yield the arrays of numbers in a value, each named as one would write it.

    Looks into dataclasses, sequences, mappings and pandas tables.

    Parameters
    ----------
    value
        Anything; arrays are looked for inside of it.
    name
        What it is called.
    """
    if isinstance(value, (np.ndarray, float)):
        array = np.asarray(value)
        if array.dtype.kind in "biufc":
            yield name, array
    for part, held in _parts(value):
        yield from arrays(held, f"{name}{part}")


def _parts(value: Any) -> Iterable[tuple[str, Any]]:
    if is_dataclass(value) and not isinstance(value, type):
        return ((f".{one.name}", getattr(value, one.name, None)) for one in fields(value))
    if isinstance(value, Mapping):
        return ((f"[{key!r}]", held) for key, held in value.items())
    if isinstance(value, (list, tuple)):
        return ((f"[{place}]", held) for place, held in enumerate(value))
    if hasattr(value, "columns") and hasattr(value, "iloc"):
        return ((f"[{one!r}]", value[one].to_numpy()) for one in value.columns)
    return ()


def infinite(values: Mapping[str, Any]) -> str:
    """Return the place of an infinite number in values by name, or an empty text.

    Parameters
    ----------
    values
        Values by name.
    """
    for place, array in _of_all(values):
        if array.dtype.kind in "fc" and np.isinf(array).any():
            index = ", ".join(str(one) for one in np.argwhere(np.isinf(array))[0])
            return f"{place}[{index}]" if index else place
    return ""


def oddities(value: Any) -> set[str]:
    """Return what is odd about the numbers of a value: infinite, missing, or missing in part.

    Parameters
    ----------
    value
        Anything; numbers are looked for inside of it.
    """
    found: set[str] = set()
    for _, array in arrays(value):
        if array.dtype.kind in "fc" and not np.isfinite(array).all():
            nan = np.isnan(np.atleast_1d(array))
            found |= {"infinite"} if np.isinf(array).any() else set()
            found |= {"missing"} if nan.any() else set()
            found |= {"missing in part"} if np.any(nan.any(-1) & ~nan.all(-1)) else set()
    return found


def kept_between(one: Mapping[str, Any], other: Mapping[str, Any], given: Mapping[str, Any]) -> str:
    """Return which array the outcomes of two calls share that no input has, or an empty text.

    Parameters
    ----------
    one, other
        What came out of two calls, by port.
    given
        What went in, whose arrays may come out again.
    """
    theirs = [array for _, array in _of_all(given)]
    for (place, first), (_, second) in zip(_of_all(one), _of_all(other), strict=False):
        if _overlap(first, second) and not any(_overlap(first, array) for array in theirs):
            return place
    return ""


def _of_all(values: Mapping[str, Any]) -> Iterator[tuple[str, NDArray[Any]]]:
    for name, value in values.items():
        yield from arrays(value, name)


def _overlap(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return bool(one.size) and np.may_share_memory(one, other) and np.shares_memory(one, other)


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


_MUTATES = (
    "changes its inputs, which other nodes read as well: copy before you write, "
    "positions = recording.positions.copy()"
)
_KEEPS = (
    "returns what it keeps between calls, so that whoever changes it changes earlier results: make "
    "the answer anew in every call, without a cache or a buffer of the module"
)
_INFINITE = (
    "makes infinite numbers out of finite ones: find where it divides by zero or overflows, and "
    "raise nodegraph.Refusal, or leave such a sample missing"
)


@dataclass(frozen=True)
class Trial:
    """A node on one specimen, with the settings that were given."""

    node: Node
    specimen: str
    inputs: Mapping[str, Any]
    settings: Mapping[str, Any]
    faults: Faults

    def fault(self, text: str, detail: str = "") -> None:
        """Note a fault that this specimen shows.

        Parameters
        ----------
        text
            What is wrong, and what to change.
        detail
            How it shows.
        """
        self.faults.add(text, specimen=self.specimen, detail=detail)

    def outputs(self) -> Mapping[str, Any] | str | None:
        """Call the node twice and watch it.

        Returns
        -------
        mapping of port to value, str or None
            What came out; or why the node declined this specimen; or None after a fault.
        """
        before = copy.deepcopy((self.inputs, self.settings))
        returned, left = self._watched()
        for fault, shown in left.items():
            self.fault(fault, shown)
        changed = self._changed(before)
        if changed:
            self.fault(_MUTATES, changed)
            return None
        if isinstance(returned, BaseException):
            return self._declined(returned)
        made = self._promised(returned)
        if made is None or left:
            return None
        if where := infinite(made) if not infinite(self.inputs) else "":
            self.fault(_INFINITE, where)
        return self._repeated(made)

    def _watched(self) -> tuple[Any, Mapping[str, str]]:
        """Return what was returned or raised, and what was left otherwise than it was."""
        returned: Any = None
        for _ in range(2):
            with surroundings(1) as left:
                try:
                    returned = self.node.function(**self.inputs, **self.settings)
                except (Exception, SystemExit) as error:
                    returned = error
            if not left.faults:
                break
            # once may be a library that does so while it is imported
        return returned, left.faults

    def _declined(self, error: BaseException) -> str | None:
        """Return why this specimen was declined, or None where it was no declining."""
        if writes_to_locked_value(error):
            self.fault(_MUTATES, told(error))
        elif fault := fault_of(error, self.inputs):
            self.fault(fault, told(error))
        else:
            return f"{type(error).__name__}: {error}"
        return None

    def again(
        self, settings: Mapping[str, Any] | None = None, /, **inputs: Any
    ) -> Mapping[str, Any] | None:
        """Call the node with some settings and inputs exchanged; None where it declines.

        Parameters
        ----------
        settings
            Those that are exchanged.
        **inputs
            Those that are exchanged, by port.
        """
        try:
            with _quiet():
                returned = self.node.function(
                    **{**self.inputs, **inputs}, **{**self.settings, **(settings or {})}
                )
        except (NodegraphError, ValueError):
            return None
        return self._promised(returned)

    def _promised(self, returned: Any) -> Mapping[str, Any] | None:
        try:
            values = values_of(self.node, returned)
        except TypeError as error:
            self.fault(f"{error}; change the annotation or what it returns")
            return None
        return dict(zip((port.name for port in self.node.outputs), values, strict=True))

    def _repeated(self, made: Mapping[str, Any]) -> Mapping[str, Any] | None:
        try:
            with surroundings(2):
                second = self.node.function(*self._positional(), **self.settings)
        except (Exception, SystemExit) as error:
            self.fault(
                "fails when it is called a second time, with its ports by position: keep no "
                "state between calls",
                told(error),
            )
            return None
        promised = self._promised(second)
        if promised is None:
            return None
        differs = next(
            filter(None, (difference(made[one], promised[one], name=one) for one in made)), ""
        )
        if differs:
            self.fault(self._unrepeatable(), differs)
            return None
        if place := kept_between(made, promised, {**self.inputs, **self.settings}):
            self.fault(_KEEPS, f"{place} is one and the same array in two calls")
        return made

    def _positional(self) -> list[Any]:
        """Return the inputs in the order of the ports; an open port in between is None."""
        names = [port.name for port in self.node.inputs]
        last = max((names.index(name) for name in self.inputs), default=-1)
        return [self.inputs.get(name) for name in names[: last + 1]]

    def _changed(self, before: tuple[Mapping[str, Any], Mapping[str, Any]]) -> str:
        inputs, settings = before
        pairs = [(name, inputs[name], self.inputs[name]) for name in inputs]
        pairs += [(name, settings[name], self.settings[name]) for name in settings]
        return next(filter(None, (difference(a, b, name=name) for name, a, b in pairs)), "")

    def _unrepeatable(self) -> str:
        if "seed" in self.node.settings:
            return (
                "gives another answer when it is called again with the same seed: draw "
                "everything random from numpy.random.default_rng(seed)"
            )
        return (
            "gives another answer when it is called again: is it random? then give it a setting "
            "`seed: int = 0` and draw from numpy.random.default_rng(seed); keep no state"
        )


@contextmanager
def _quiet() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
