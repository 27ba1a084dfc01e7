"""One node called on one specimen: what it did to its inputs, to chance and to its answer."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from nodegraph.equality import difference
from nodegraph.errors import NodegraphError
from nodegraph.execute.call import values_of, writes_to_what_is_locked
from nodegraph.node import Node
from nodegraph.testing.errors import fault_of, told
from nodegraph.testing.faults import Faults
from nodegraph.testing.parts import infinite, kept_between
from nodegraph.testing.surroundings import surroundings

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
        if writes_to_what_is_locked(error):
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
