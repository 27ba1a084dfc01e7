"""One node called on one specimen: its answer, its errors, and its effects on anything else."""

from __future__ import annotations

import copy
import linecache
import traceback
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from nodegraph.equality import difference
from nodegraph.errors import NodegraphError
from nodegraph.execute.call import values_of
from nodegraph.execute.outcome import writes_to_locked_value
from nodegraph.node.decorator import Node
from nodegraph.node.values import Value
from nodegraph.testing.arrays import first_infinite, first_shared, oddities
from nodegraph.testing.faults import Faults
from nodegraph.testing.side_effects import side_effects

_LIBRARIES = {"numpy", "scipy", "pandas", "sklearn", "numba", "pywt", "matplotlib", "networkx"}

_MODIFIES_INPUTS = (
    "modifies its inputs, which other nodes read as well: copy before you write, "
    "positions = recording.positions.copy()"
)
_SHARES_ARRAYS = (
    "returns an array that it keeps between calls, so that writing to it changes earlier results: "
    "build a new result in every call, without a cache or a buffer of the module"
)
_INFINITE = (
    "makes infinite numbers out of finite ones: find where it divides by zero or overflows, and "
    "raise nodegraph.Refusal, or leave such a sample missing"
)
_DECLINE = (
    'raise nodegraph.Refusal("what it needs") where this data cannot be done, or ValueError '
    "with the place and what is wrong"
)
_FAILS_BY_POSITION = (
    "fails when it is called a second time, with its ports by position: keep no state between calls"
)
_SEEDED_BUT_RANDOM = (
    "returns another result when it is called again with the same seed: draw everything random "
    "from numpy.random.default_rng(seed)"
)
_RANDOM = (
    "returns another result when it is called again: is it random? then give it a setting "
    "`seed: int = 0` and draw from numpy.random.default_rng(seed); keep no state"
)


@dataclass(frozen=True)
class Trial:
    """A node, a specimen with a value for each port, settings, and the faults that show."""

    node: Node
    specimen: str
    inputs: Mapping[str, object]
    settings: Mapping[str, object]
    faults: Faults

    def add_fault(self, fault: str, detail: str = "") -> None:
        """Note a fault that this specimen shows."""
        self.faults.add(fault, specimen=self.specimen, detail=detail)

    def outputs(self) -> Mapping[str, object] | str | None:
        """Call the node twice and note its faults.

        Returns
        -------
        mapping of port to value, str or None
            The outputs; or why the node declined this specimen; or None after a fault.
        """
        inputs, settings = copy.deepcopy((self.inputs, self.settings))
        returned, effects = self._call()
        for fault, detail in effects.items():
            self.add_fault(fault, detail)
        changed = _first_difference(inputs, self.inputs) or _first_difference(
            settings, self.settings
        )
        if changed:
            self.add_fault(_MODIFIES_INPUTS, changed)
            return None
        if isinstance(returned, BaseException):
            return self._declined(returned)
        outputs = self._by_port(returned)
        if outputs is None or effects:
            return None
        place = first_infinite(outputs)
        if place and not first_infinite(self.inputs):
            self.add_fault(_INFINITE, place)
        return outputs if self._is_repeatable(outputs) else None

    def again(
        self, settings: Mapping[str, object] | None = None, /, **inputs: object
    ) -> Mapping[str, object] | None:
        """Call the node with some settings and inputs replaced; None if it declines."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                returned = self.node.function(
                    **{**self.inputs, **inputs}, **{**self.settings, **(settings or {})}
                )
        except (NodegraphError, ValueError):
            return None
        return self._by_port(returned)

    def _call(self) -> tuple[object, Mapping[str, str]]:
        """Return what the node returned or raised, and its side effects."""
        returned: object = None
        for _ in range(2):
            with side_effects(1) as effects:
                try:
                    returned = self.node.function(**self.inputs, **self.settings)
                except (Exception, SystemExit) as error:
                    returned = error
            if not effects:
                break
            # the first time may be a library that does so while it is imported
        return returned, effects

    def _declined(self, error: BaseException) -> str | None:
        """Return why the node declined this specimen, or None if its error is a fault."""
        if writes_to_locked_value(error):
            self.add_fault(_MODIFIES_INPUTS, with_line(error))
        elif fault := _error_fault(error, self.inputs):
            self.add_fault(fault, with_line(error))
        else:
            return f"{type(error).__name__}: {error}"
        return None

    def _by_port(self, returned: object) -> Mapping[str, object] | None:
        try:
            values = values_of(self.node, returned)
        except TypeError as error:
            self.add_fault(f"{error}; change the annotation or what it returns")
            return None
        return dict(zip((port.name for port in self.node.outputs), values, strict=True))

    def _is_repeatable(self, outputs: Mapping[str, object]) -> bool:
        try:
            with side_effects(2):
                returned = self.node.function(*self._positional(), **self.settings)
        except (Exception, SystemExit) as error:
            self.add_fault(_FAILS_BY_POSITION, with_line(error))
            return False
        repeated = self._by_port(returned)
        if repeated is None:
            return False
        if changed := _first_difference(outputs, repeated):
            fault = _SEEDED_BUT_RANDOM if "seed" in self.node.settings else _RANDOM
            self.add_fault(fault, changed)
            return False
        if place := first_shared(outputs, repeated, {**self.inputs, **self.settings}):
            self.add_fault(_SHARES_ARRAYS, f"{place} is the same array in two calls")
        return True

    def _positional(self) -> list[object]:
        """Return the inputs in the order of the ports; an open port in between is None."""
        names = [port.name for port in self.node.inputs]
        last = max((names.index(name) for name in self.inputs), default=-1)
        return [self.inputs.get(name) for name in names[: last + 1]]


def _first_difference(first: Mapping[str, object], second: Mapping[str, object]) -> str:
    differences = (difference(value, second[name], name=name) for name, value in first.items())
    return next(filter(None, differences), "")


def _error_fault(error: BaseException, inputs: object) -> str:
    """Return what is wrong with raising an error; an empty text if it declines in clear words.

    A node declines by `nodegraph.NodegraphError`, which includes a refusal, or by a ValueError
    that is raised on purpose: not by one that escapes from the inside of a library, nor by one
    that says that the node's own result is invalid.
    """
    if isinstance(error, NodegraphError):
        return ""
    if not isinstance(error, ValueError):
        return f"raises {type(error).__name__} on odd data: handle it, {_DECLINE}"
    if odd := oddities(_value_in_construction(error)) - oddities(inputs):
        return (
            f"makes numbers that are {' and '.join(sorted(odd))}, out of such as are not: find "
            f"where it divides by zero or overflows, or {_DECLINE}"
        )
    if library := _library(error):
        return f"lets an error of {library} out, which does not tell users what to fix: {_DECLINE}"
    return ""


def with_line(error: BaseException) -> str:
    """Return an error with the file and line that raised it."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    message = str(error) or "no message"
    return f"{type(error).__name__}: {message} ({Path(last.filename).name}:{last.lineno})"


def _value_in_construction(error: BaseException) -> Value | None:
    """Return the value whose constructor raised the error, if one did."""
    for frame, _ in traceback.walk_tb(error.__traceback__):
        value = frame.f_locals.get("self")
        if frame.f_code.co_name == "__post_init__" and isinstance(value, Value):
            return value
    return None


def _library(error: BaseException) -> str:
    """Return the source of an error that no ``raise`` in readable Python has raised."""
    *_, (frame, line) = traceback.walk_tb(error.__traceback__)
    package = str(frame.f_globals.get("__name__", "")).partition(".")[0]
    if package in _LIBRARIES:
        return package
    return "" if _raises(frame, line) else "a library, or of Python,"


def _raises(frame: FrameType, line: int) -> bool:
    """Return whether a line is a ``raise``, or cannot be read."""
    text = linecache.getline(frame.f_code.co_filename, line, frame.f_globals).strip()
    return not text or "raise" in text.split("#")[0]
