"""Why a step is not cached: which part of its key changed since an earlier run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import networkx as nx

from nodegraph.execute import Run
from nodegraph.execute.events import plain
from nodegraph.execute.resume import StoredSteps
from nodegraph.plan import Output, Plan, Step, StepInput
from nodegraph.runs.changes import (
    code_changes,
    file_change,
    recorded_sources,
    setting_changes,
    source_changes,
    source_text,
)
from nodegraph.runs.record import Record, RecordedStep
from nodegraph.state import State

_Cell = tuple[str, tuple[tuple[str, object], ...]]


@dataclass(frozen=True)
class Explanation:
    """Why a step is cached or not.

    Attributes
    ----------
    step : Step
    stored : bool
        Whether its result is in the store now.
    changes : tuple of str
        What changed since the earlier run, root causes upstream included; if nothing did, why
        there is no result all the same.
    """

    step: Step
    stored: bool
    changes: tuple[str, ...]


def changes_since(run: Run, record: Record, indices: Iterable[int]) -> tuple[str, ...]:
    """Return the changes since a run in everything that some of its steps depend on.

    If anything has changed, or may have, they cannot be computed as they were then.

    Parameters
    ----------
    run
        Opened from its folder.
    record
        Of the run.
    indices
        Steps of its plan.
    """
    if not record.settings.cache or run.cache is None:
        return ("the run stored nothing (--no-cache), so what has changed is not known",)
    needed = set(indices)
    needed |= {above for index in needed for above in nx.ancestors(run.plan.network, index)}
    changed = (
        index
        for index in sorted(needed)
        if run.outcomes[index].state.has_value
        and run.cache.key(run.plan.steps[index], run.outcomes) != run.outcomes[index].key
    )
    why = Why(run.plan, run.cache, record)
    return tuple(
        dict.fromkeys(text for index in changed for text in why.explain_step(index).changes)
    )


class Why:
    """Compares a plan with the record of an earlier run.

    Parameters
    ----------
    plan
    cache
        Of the plan.
    record
        Of the earlier run.
    """

    def __init__(self, plan: Plan, cache: StoredSteps, record: Record) -> None:
        self._plan = plan
        self._cache = cache
        self._code = record.code
        self._by_index = {step.step: step for step in record.steps}
        self._by_cell = {_cell(step.node, step.labels): step for step in record.steps}
        self._by_key = {step.key: step for step in record.steps if step.key}
        self._changes: dict[int, tuple[str, ...]] = {}

    def explain(self, node: str) -> Iterator[Explanation]:
        """Yield an explanation for each step of a node."""
        yield from map(self.explain_step, dict.fromkeys(self._plan.cells[node].values()))

    def explain_step(self, index: int) -> Explanation:
        """Return the explanation for a step."""
        step = self._plan.steps[index]
        stored = index in self._cache
        changes = self._all_changes(index)
        if not stored and not changes:
            changes = (self._reason(step),)
        return Explanation(step, stored, changes)

    def _reason(self, step: Step) -> str:
        """Return why a step without changes has no result."""
        outcome, earlier = self._cache.known.get(step.index), self._earlier(step)
        if outcome is not None:
            return f"{outcome.state}, as before: {outcome.reason}"
        if earlier is not None and earlier.state is State.DONE and not earlier.digests:
            return "its key is unchanged; the earlier run could not store its result"
        return "its key is unchanged; the result is not in the store"

    def _earlier(self, step: Step) -> RecordedStep | None:
        """Return the recorded step of the same key, else of the same combination."""
        same_key = self._by_key.get(self._cache.expected_key(step.index))
        return same_key or self._by_cell.get(_cell(step.node, step.labels))

    def _all_changes(self, index: int) -> tuple[str, ...]:
        """Return the changes of a step and of everything upstream, each once."""
        indices = {index} | nx.ancestors(self._plan.network, index)
        changes = (text for index in sorted(indices) for text in self._own_changes(index))
        return tuple(dict.fromkeys(changes))

    def _own_changes(self, index: int) -> tuple[str, ...]:
        if index not in self._changes:
            step = self._plan.steps[index]
            earlier = self._earlier(step)
            self._changes[index] = tuple(
                self._compare(step, earlier) if earlier else self._new(step)
            )
        return self._changes[index]

    def _new(self, step: Step) -> list[str]:
        """Return that a step is new, unless that follows from a new step that feeds it."""
        if any(self._earlier(self._plan.steps[index]) is None for index in step.needed):
            return []
        return [f"{step.name}: was not in the earlier run"]

    def _compare(self, step: Step, earlier: RecordedStep) -> list[str]:
        if earlier.state is State.FAILED:
            now = "has a result now" if step.index in self._cache else "will be tried again"
            return [f"{step.name}: failed in the earlier run and {now}: {earlier.reason}"]
        if earlier.key and earlier.key == self._cache.expected_key(step.index):
            return []
        use = step.method.node.name
        if earlier.use != use:
            return [f"{step.name}: used {earlier.use}, now {use}"]
        changes = [
            *self._code_changes(step),
            *(f"{step.name}: {text}" for text in self._input_changes(step, earlier)),
        ]
        if not changes and not any(map(self._all_changes, step.needed)):
            # the record has no output positions, nor the labels that are absent from a gathering
            changes = [f"{step.name}: takes other outputs, or labels, of what feeds it"]
        return changes

    def _code_changes(self, step: Step) -> Iterator[str]:
        digest = self._cache.digest_of(step)
        use = step.method.node.name
        if digest.reason:
            yield f"{use}: its results cannot be stored: {digest.reason}"
        earlier = self._code.get(f"{step.method.plugin}:{use}")
        if earlier is not None:
            yield from (f"{use}: {text}" for text in code_changes(earlier, digest.code))
        else:
            nothing = "" if self._code else ", which stored nothing"
            yield f"{use}: its code was not recorded in the earlier run{nothing}"

    def _input_changes(self, step: Step, earlier: RecordedStep) -> Iterator[str]:
        settings = {name: plain(value) for name, value in step.shown.items()}
        files = {name for name, setting in step.method.node.settings.items() if setting.is_file}
        yield from setting_changes(earlier.settings, settings, files)
        for name, digest in self._cache.digest_of(step).files.items():
            if earlier.files.get(name) != digest:
                yield file_change(name, earlier.settings.get(name), settings.get(name))
        sources = {port: _sources(self._plan, fed) for port, fed in step.inputs.items()}
        yield from source_changes(recorded_sources(earlier, self._by_index), sources)


def _sources(plan: Plan, fed: StepInput) -> tuple[str, ...]:
    if isinstance(fed, Output):
        return (_output(plan, fed, {}),)
    return tuple(
        _output(plan, output, dict(zip(fed.axes, labels, strict=True)))
        for labels, output in fed.entries
    )


def _output(plan: Plan, output: Output, labels: Mapping[str, object]) -> str:
    step = plan.steps[output.step]
    return source_text(step.node, step.method.node.outputs[output.position].name, plain(labels))


def _cell(node: str, labels: Mapping[str, object]) -> _Cell:
    return node, tuple(sorted(plain(labels).items()))
