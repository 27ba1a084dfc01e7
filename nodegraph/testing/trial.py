"""One node called on one specimen: what it did to its inputs, to chance and to its answer."""

from __future__ import annotations

import copy
import random
import traceback
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph.equality import difference
from nodegraph.errors import NodegraphError
from nodegraph.execute.call import values_of
from nodegraph.node import Node
from nodegraph.testing.faults import Faults

_DECLINED = (NodegraphError, ValueError)
_WRITES = ("read-only", "readonly", "WRITEABLE", "cannot assign to field")
"""What numpy, numba and frozen dataclasses say when somebody writes to what is locked."""

_MUTATES = (
    "changes its inputs, which other nodes read as well: copy before you write, "
    "positions = recording.positions.copy()"
)
_GLOBAL = (
    "draws from the global random state, so that no run can be repeated: draw from "
    "numpy.random.default_rng(seed), where `seed: int = 0` is a setting"
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
        """Note a fault that this specimen shows."""
        self.faults.add(text, specimen=self.specimen, detail=detail)

    def outputs(self) -> Mapping[str, Any] | str | None:
        """Call the node twice and watch it.

        Returns
        -------
        mapping of port to value, str or None
            What came out; or why the node declined this specimen; or None after a fault.
        """
        before = copy.deepcopy((self.inputs, self.settings))
        try:
            made, drawn = self._watched()
        except Exception as error:
            self._note_error(error)
            return None
        if drawn:
            self.fault(_GLOBAL)
            return None
        changed = self._changed(before)
        if changed or (isinstance(made, str) and _is_write(made)):
            self.fault(_MUTATES, changed or str(made))
            return None
        return made if made is None or isinstance(made, str) else self._repeated(made)

    def _watched(self) -> tuple[Mapping[str, Any] | str | None, bool]:
        """Return what came out, or why it declined, and whether it drew from a global state."""
        for _ in range(2):
            with _chance(1) as drawn:
                try:
                    made: Mapping[str, Any] | str | None = self.call(self.inputs)
                except _DECLINED as declined:
                    made = f"{type(declined).__name__}: {declined}"
            if not drawn():
                return made, False
            # once may be a library that draws while it is imported
        return made, True

    def call(
        self, inputs: Mapping[str, Any], settings: Mapping[str, Any] | None = None
    ) -> Mapping[str, Any] | None:
        """Call the node as the machine does; None when it returned what it does not promise."""
        with _quiet():
            returned = self.node.function(**inputs, **{**self.settings, **(settings or {})})
        return self._promised(returned)

    def again(
        self, settings: Mapping[str, Any] | None = None, /, **inputs: Any
    ) -> Mapping[str, Any] | None:
        """Call the node with some settings and inputs exchanged; None where it declines."""
        try:
            return self.call({**self.inputs, **inputs}, settings)
        except _DECLINED:
            return None

    def _promised(self, returned: Any) -> Mapping[str, Any] | None:
        try:
            values = values_of(self.node, returned)
        except TypeError as error:
            self.fault(f"{error}; change the annotation or what it returns")
            return None
        return dict(zip((port.name for port in self.node.outputs), values, strict=True))

    def _repeated(self, made: Mapping[str, Any]) -> Mapping[str, Any] | None:
        try:
            with _chance(2), _quiet():
                second = self.node.function(*self._positional(), **self.settings)
        except Exception as error:
            self.fault(
                "fails when it is called a second time, with its ports by position: keep no "
                "state between calls",
                _told(error),
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

    def _note_error(self, error: Exception) -> None:
        if _is_write(str(error)):
            self.fault(_MUTATES, _told(error))
            return
        self.fault(
            f"raises {type(error).__name__} on odd data: handle it, raise "
            'nodegraph.Refusal("what it needs") where this data cannot be done, or ValueError '
            "with the place and what is wrong",
            _told(error),
        )


def _is_write(message: str) -> bool:
    return any(sign in message for sign in _WRITES)


@contextmanager
def _quiet() -> Iterator[None]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


@contextmanager
def _chance(seed: int) -> Iterator[Any]:
    """Seed the global random states, tell afterwards whether they were used, and restore them."""
    kept = random.getstate(), np.random.get_state()  # noqa: NPY002  (it is what is watched)
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002
    began = _states()
    used: list[bool] = []
    try:
        yield lambda: bool(used and used[0])
    finally:
        used.append(bool(difference(began, _states())))
        random.setstate(kept[0])
        np.random.set_state(kept[1])  # noqa: NPY002


def _states() -> tuple[Any, ...]:
    return random.getstate(), np.random.get_state(legacy=False)  # noqa: NPY002


def _told(error: Exception) -> str:
    last = traceback.extract_tb(error.__traceback__)[-1]
    said = str(error) or "no message"
    return f"{type(error).__name__}: {said} ({Path(last.filename).name}:{last.lineno})"
