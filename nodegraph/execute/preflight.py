"""Before a run: whether settings fit the inputs of their nodes, as far as these are at hand."""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from nodegraph.errors import Place, Problems
from nodegraph.execute.call import Call, collecting_warnings, failure, perform
from nodegraph.execute.step_cache import StepCache
from nodegraph.plan import Output, Plan, Step, StepInput
from nodegraph.state import State

_Unmet = defaultdict[tuple[Place, str], list[Step]]
"""The steps of which the same is wrong at the same place."""

_STEPS_IN_MEMORY = 4
_LARGEST = 16 << 20
"""Bytes of a file that is read: so many takes in memory must not be takes of an hour."""


def check_requirements(plan: Plan, cache: StepCache, problems: Problems) -> None:
    """Note settings that do not fit the inputs of their nodes, and files that cannot be read.

    Requirements are tried on inputs that are stored, that are read from files of up to 16 MB, or
    that come from such through nodes that damage them. No other node is called, and nothing is
    stored.

    Parameters
    ----------
    plan
    cache
        The steps of the plan that are stored.
    problems
    """
    unmet: _Unmet = defaultdict(list)
    inputs = _Inputs(plan, cache, unmet)
    tried = set()
    with collecting_warnings():
        for step in _by_source(plan):
            requires = step.method.node.requires
            if requires is None:
                continue
            names = inspect.signature(requires).parameters
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
    for (place, reason), steps in unmet.items():
        more = f" and {len(steps) - 1} more of {steps[0].node}" if len(steps) > 1 else ""
        problems.add(place, f"{steps[0].name}{more}: {reason}")


def _by_source(plan: Plan) -> list[Step]:
    """Return the steps, those that read the same values one after the other: few are kept."""
    ways: list[tuple[int, ...]] = []
    for step in plan.steps:
        ways.append((*(ways[step.needed[0]] if step.needed else ()), step.index))
    return sorted(plan.steps, key=lambda step: ways[step.index])


class _Inputs:
    """Values that are at hand without a run."""

    def __init__(self, plan: Plan, cache: StepCache, unmet: _Unmet) -> None:
        self._plan = plan
        self._cache = cache
        self._unmet = unmet
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

    def _find_outputs(self, index: int) -> tuple[Any, ...]:
        """Return the outputs of a step, none if they are not at hand."""
        step = self._plan.steps[index]
        node = step.method.node
        if self._cache.gives(index, range(len(node.outputs))):
            return self._cache.load(index) or ()
        files = [name for name, setting in node.settings.items() if setting.is_file]
        if not (node.damages if step.inputs else files):
            return ()
        paths = [Path(str(step.settings[name])) for name in files if step.settings.get(name)]
        if any(path.stat().st_size > _LARGEST for path in paths):
            return ()
        inputs = self.of(step.inputs)
        if inputs is None:
            return ()
        registry = self._plan.graph.registry
        call = Call(index, node, step.method.plugin, inputs, step.settings, registry=registry)
        outcome = perform(call)
        if outcome.state is State.FAILED:
            _note(self._unmet, step, files, outcome.message)
        return outcome.values


def _note(unmet: _Unmet, step: Step, settings: Iterable[str], reason: str) -> None:
    """Note a reason at the first of these settings that is written, else at the node."""
    places = step.method.places
    place = next((places[name] for name in settings if name in places), step.method.place)
    unmet[place, reason].append(step)
