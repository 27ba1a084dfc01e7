"""Why a step would run again: which part of its key is not as it was in an earlier run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nodegraph.execute.events import plain
from nodegraph.execute.step_cache import StepCache
from nodegraph.plan import Output, Plan, Step, StepInput
from nodegraph.runs.changes import (
    code_changed,
    recorded_sources,
    settings_changed,
    source,
    sources_changed,
)
from nodegraph.state import State

_Cell = tuple[str, tuple[tuple[str, Any], ...]]


@dataclass(frozen=True)
class Explained:
    """What is to be said of one step.

    Attributes
    ----------
    step : Step
    stored : bool
        Whether its result is in the store now.
    changes : tuple of str
        What differs from the earlier run, the root causes upstream included; if nothing does,
        why there is no result all the same.
    """

    step: Step
    stored: bool
    changes: tuple[str, ...]


class Why:
    """Compares a plan with the record of an earlier run.

    Parameters
    ----------
    plan
    cache
        Of the plan.
    record
        The earlier run's record, as ``run.json`` holds it.
    """

    def __init__(
        self,
        plan: Plan,
        cache: StepCache,
        record: Mapping[str, Any],
    ) -> None:
        self._plan = plan
        self._cache = cache
        self._code = record.get("code", {})
        steps = record["steps"]
        self._by_index: dict[int, Mapping[str, Any]] = {one["step"]: one for one in steps}
        self._before: dict[_Cell, Mapping[str, Any]] = {
            _cell(one["node"], one["labels"]): one for one in steps
        }
        self._keys = {one["key"]: one for one in steps if one.get("key")}
        self._changes: dict[int, tuple[str, ...]] = {}

    def explain(self, node: str) -> Iterator[Explained]:
        """Yield what is to be said of each step of a node."""
        for index in dict.fromkeys(self._plan.cells[node].values()):
            step = self._plan.steps[index]
            stored = index in self._cache
            changes = self._upstream(step)
            if not stored and not changes:
                changes = (self._lacking(step),)
            yield Explained(step, stored, changes)

    def _lacking(self, step: Step) -> str:
        """Return why a step of which nothing has changed has no result."""
        ended, before = self._cache.known.get(step.index), self._earlier(step)
        if ended is not None:
            return f"{ended.state}, as before: {ended.reason}"
        if before is not None and before["state"] == State.DONE and not before.get("digests"):
            return "its key is as it was; that run could not store its result"
        return "its key is as it was; the result is not in the store"

    def _earlier(self, step: Step) -> Mapping[str, Any] | None:
        """Return what the record has of a step, or of one that had the same result."""
        same = self._keys.get(self._cache.expected_key(step.index))
        return same or self._before.get(_cell(step.node, step.labels))

    def _upstream(self, step: Step) -> tuple[str, ...]:
        """Return the changes of a step, and of all that it needs, each told once."""
        needed = {step.index}
        pending = [step]
        while pending:
            for one in pending.pop().needed:
                if one not in needed:
                    needed.add(one)
                    pending.append(self._plan.steps[one])
        found = (change for index in sorted(needed) for change in self._of(self._plan.steps[index]))
        return tuple(dict.fromkeys(found))

    def _of(self, step: Step) -> tuple[str, ...]:
        if step.index not in self._changes:
            before = self._earlier(step)
            found = self._compared(step, before) if before else self._new(step)
            self._changes[step.index] = tuple(found)
        return self._changes[step.index]

    def _new(self, step: Step) -> list[str]:
        """Return that a step is new, if not all that follows from one that feeds it."""
        if any(self._earlier(self._plan.steps[one]) is None for one in step.needed):
            return []
        return [_named(step, "was not in that run")]

    def _compared(self, step: Step, before: Mapping[str, Any]) -> list[str]:
        if before["state"] == State.FAILED:
            then = "; it has a result now" if step.index in self._cache else ", and is tried again"
            return [_named(step, f"failed in that run{then}: {before.get('reason')}")]
        if before.get("key") and before["key"] == self._cache.expected_key(step.index):
            return []
        use = step.method.node.name
        if before["use"] != use:
            return [_named(step, f"used {before['use']}, now {use}")]
        found = [
            *self._code_changes(step),
            *_settings(step, before),
            *self._files(step, before),
            *self._wiring(step, before),
        ]
        return found or self._unnamed(step)

    def _unnamed(self, step: Step) -> list[str]:
        """Return that a step's key differs in what no record says, if nothing upstream does."""
        if any(self._upstream(self._plan.steps[one]) for one in step.needed):
            return []
        return [_named(step, "takes other outputs, or labels, of what feeds it")]

    def _code_changes(self, step: Step) -> Iterator[str]:
        digest = self._cache.digest_of(step)
        before = self._code.get(f"{step.method.plugin}:{step.method.node.name}")
        use = step.method.node.name
        if digest.reason:
            yield f"{use}: its results cannot be stored: {digest.reason}"
        if before is None:
            yield f"{use}: its code was not noted in that run" + (
                "" if self._code else ", which stored nothing"
            )
            return
        now = {"units": digest.code.units, "versions": digest.code.versions}
        yield from (f"{use}: {said}" for said in code_changed(before, now))

    def _files(self, step: Step, before: Mapping[str, Any]) -> Iterator[str]:
        for name, digest in self._cache.digest_of(step).files.items():
            if before.get("files", {}).get(name) != digest:
                yield _named(step, f"{name}: the content of {step.settings[name]} is another")

    def _wiring(self, step: Step, before: Mapping[str, Any]) -> Iterator[str]:
        was = recorded_sources(before, self._by_index)
        now = {port: _sources(self._plan, fed) for port, fed in step.inputs.items()}
        yield from (_named(step, said) for said in sources_changed(was, now))


def _settings(step: Step, before: Mapping[str, Any]) -> Iterator[str]:
    now = {name: plain(value) for name, value in step.shown.items()}
    files = {name for name, one in step.method.node.settings.items() if one.is_file}
    changed = settings_changed(before["settings"], now, files)
    yield from (_named(step, said) for said in changed)


def _named(step: Step, said: str) -> str:
    return f"{step.name}: {said}"


def _sources(plan: Plan, fed: StepInput) -> tuple[str, ...]:
    if isinstance(fed, Output):
        return (_output(plan, fed, {}),)
    return tuple(
        _output(plan, one, dict(zip(fed.axes, at, strict=True))) for at, one in fed.entries
    )


def _output(plan: Plan, output: Output, labels: Mapping[str, Any]) -> str:
    step = plan.steps[output.step]
    return source(step.node, step.method.node.outputs[output.position].name, plain(labels))


def _cell(node: str, labels: Mapping[str, Any]) -> _Cell:
    return node, tuple(sorted(plain(labels).items()))
