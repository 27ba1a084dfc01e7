"""Before a run: whether files can be read, and settings fit the inputs of their nodes."""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from nodegraph.errors import Place, Problems
from nodegraph.execute.call import Call, collecting_warnings, perform
from nodegraph.execute.outcome import Outcome, failure
from nodegraph.execute.resume import StoredSteps
from nodegraph.plan import Output, Plan, Step, StepInput
from nodegraph.state import State

_Unmet = defaultdict[tuple[Place, str], list[Step]]
"""The steps of which the same is wrong at the same place."""

_STEPS_IN_MEMORY = 4
_LARGEST = 16 << 20
"""Bytes of a file that is read: so many takes in memory must not be takes of an hour."""


def check_files_and_settings(plan: Plan, stored: StoredSteps, problems: Problems) -> list[str]:
    """Note files that cannot be read, and settings that do not fit the inputs of their nodes.

    Files of up to 16 MB are read, unless the result of that is stored. Settings are tried on
    inputs that are stored, that are read, or that come from such through nodes that damage them.
    No other node is called, and nothing is stored.

    Parameters
    ----------
    plan
    stored
        The steps of the plan that are stored.
    problems

    Returns
    -------
    list of str
        What reading the files warns of.
    """
    unmet: _Unmet = defaultdict(list)
    inputs = _Inputs(plan, stored, unmet)
    tried = set()
    with collecting_warnings():
        for step in _by_source(plan):
            requires = step.method.node.requires
            if requires is None:
                continue
            names = _parameters(requires)
            ports = {
                port.name: step.inputs.get(port.name)
                for port in step.method.node.inputs
                if port.name in names
            }
            settings = {name: value for name, value in step.settings.items() if name in names}
            call = (requires, *ports.items(), repr(settings))
            if call in tried:
                continue
            tried.add(call)
            values = inputs.of(ports)
            if values is None:
                continue
            try:
                requires(**values, **settings)
            except Exception as error:
                _note(unmet, step, settings, failure(step.method.node, error).reason)
        inputs.read_the_others()
    for (place, reason), steps in unmet.items():
        problems.add(place, f"{_names(steps)}: {reason}")
    return [f"{_names(steps)}: {warning}" for warning, steps in inputs.warnings.items()]


@cache
def _parameters(requires: Callable[..., object]) -> frozenset[str]:
    return frozenset(inspect.signature(requires).parameters)


def _names(steps: list[Step]) -> str:
    more = f" and {len(steps) - 1} more of {steps[0].node}" if len(steps) > 1 else ""
    return f"{steps[0].name}{more}"


def _by_source(plan: Plan) -> list[Step]:
    """Return the steps, those that read the same values one after the other: few are kept."""
    ways: list[tuple[int, ...]] = []
    for step in plan.steps:
        ways.append((*(ways[step.needed[0]] if step.needed else ()), step.index))
    return sorted(plan.steps, key=lambda step: ways[step.index])


class _Inputs:
    """Values that are at hand without a run.

    Attributes
    ----------
    warnings : dict of str to list of Step
        Warnings given when files were read.
    """

    def __init__(self, plan: Plan, stored: StoredSteps, unmet: _Unmet) -> None:
        self.warnings: defaultdict[str, list[Step]] = defaultdict(list)
        self._plan = plan
        self._stored = stored
        self._unmet = unmet
        self._states: dict[int, State] = {}
        self._outputs = lru_cache(_STEPS_IN_MEMORY)(self._find_outputs)

    def of(self, sources: Mapping[str, StepInput | None]) -> dict[str, Any] | None:
        """Return the values at ports, None at an open one; or None if one is not at hand."""
        values: dict[str, Any] = {}
        for port, source in sources.items():
            if source is None:
                values[port] = None
                continue
            if not isinstance(source, Output) or not (outputs := self._outputs(source.step)):
                return None
            values[port] = outputs[source.position]
        return values

    def read_the_others(self) -> None:
        """Read the files that no setting was tried on."""
        for step in self._plan.steps:
            if not step.inputs and step.index not in self._states and _files(step):
                if step.index in self._stored:
                    self._add(step, self._stored.known[step.index])
                else:
                    self._find_outputs(step.index)

    def _find_outputs(self, index: int) -> tuple[Any, ...]:
        """Return the outputs of a step, none if they are not at hand."""
        step = self._plan.steps[index]
        node = step.method.node
        if self._stored.gives(index, range(len(node.outputs))):
            self._add(step, self._stored.known[index])
            return self._stored.load(index) or ()
        files = _files(step)
        if not (node.damages if step.inputs else files):
            return ()
        # a file that failed once is not read again, after others have taken its place in memory
        if self._states.get(index) == State.FAILED or sum(map(_size, files)) > _LARGEST:
            return ()
        inputs = self.of(step.inputs)
        if inputs is None:
            return ()
        registry = self._plan.graph.registry
        call = Call(index, node, step.method.plugin, inputs, step.settings, registry=registry)
        outcome = perform(call)
        self._add(step, outcome)
        return outcome.values

    def _add(self, step: Step, outcome: Outcome) -> None:
        """Note the outcome of a step, once."""
        if step.index in self._states:
            return
        self._states[step.index] = outcome.state
        files = [name for name, setting in step.method.node.settings.items() if setting.is_file]
        if outcome.state is State.FAILED:
            _note(self._unmet, step, files, outcome.message)
        if files and not step.inputs:
            for warning in outcome.warnings:
                self.warnings[warning].append(step)


def _files(step: Step) -> list[Path]:
    """Return the files and folders that the settings of a step name."""
    settings = step.method.node.settings
    names = [name for name, setting in settings.items() if setting.is_file]
    return [Path(str(step.settings[name])) for name in names if step.settings.get(name)]


def _size(path: Path) -> int:
    """Return the bytes of a file, or of all files in a folder."""
    files = path.rglob("*") if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file())


def _note(unmet: _Unmet, step: Step, settings: Iterable[str], reason: str) -> None:
    """Note a reason at the first of these settings that is written, else at the node."""
    places = step.method.places
    place = next((places[name] for name in settings if name in places), step.method.place)
    unmet[place, reason].append(step)
