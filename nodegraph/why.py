"""Why a step would run again: which part of its key is not as it was in an earlier run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from nodegraph.execute.events import plain
from nodegraph.execute.recall import Recall
from nodegraph.plan import Gathered, Plan, Step

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
        What differs from the earlier run, the root causes upstream included.
    """

    step: Step
    stored: bool
    changes: tuple[str, ...]


class Why:
    """Compares a plan with the record of an earlier run.

    Parameters
    ----------
    plan
    recall
        In which the plan has been looked up.
    record
        The earlier run's record, as ``run.json`` holds it.
    """

    def __init__(self, plan: Plan, recall: Recall, record: Mapping[str, Any]) -> None:
        self._plan = plan
        self._recall = recall
        self._code = record.get("code", {})
        self._before: dict[_Cell, Mapping[str, Any]] = {
            _cell(one["node"], one["labels"]): one for one in record.get("steps", ())
        }
        self._changes: dict[int, tuple[str, ...]] = {}

    def explain(self, node: str) -> Iterator[Explained]:
        """Yield what is to be said of each step of a node."""
        for index in dict.fromkeys(self._plan.cells[node].values()):
            step = self._plan.steps[index]
            yield Explained(step, index in self._recall, self._upstream(step))

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
            before = self._before.get(_cell(step.node, step.labels))
            found = (
                self._compared(step, before) if before else [_named(step, "was not in that run")]
            )
            self._changes[step.index] = tuple(found)
        return self._changes[step.index]

    def _compared(self, step: Step, before: Mapping[str, Any]) -> list[str]:
        if before.get("key") and before["key"] == self._recall.keys.of[step.index]:
            return []
        use = step.method.node.name
        if before["use"] != use:
            return [_named(step, f"used {before['use']}, now {use}")]
        return [
            *self._code_changes(step),
            *_settings(step, before),
            *self._files(step, before),
            *_wiring(step, before),
        ]

    def _code_changes(self, step: Step) -> Iterator[str]:
        now = self._recall.keys.fixed(step).reached
        before = self._code.get(f"{step.method.plugin}:{step.method.node.name}")
        use = step.method.node.name
        if now.unstable:
            yield f"{use}: {now.unstable}"
        if before is None:
            yield f"{use}: its code was not noted in that run"
            return
        for name, how in _differences(before.get("units", {}), now.units):
            yield f"{use}: code: {name} {how}"
        for name in {**before.get("versions", {}), **now.versions}:
            was, here = before.get("versions", {}).get(name), now.versions.get(name)
            if was != here:
                yield f"{use}: {name} was {was or 'not used'}, now {here or 'not used'}"

    def _files(self, step: Step, before: Mapping[str, Any]) -> Iterator[str]:
        for name, digest in self._recall.keys.fixed(step).files.items():
            if before.get("files", {}).get(name) != digest:
                yield _named(step, f"{name}: the content of {step.settings[name]} is another")


def _settings(step: Step, before: Mapping[str, Any]) -> Iterator[str]:
    was = before["settings"]
    now = {name: plain(value) for name, value in step.shown.items()}
    files = {name for name, one in step.method.node.settings.items() if one.is_file}
    for name in {**was, **now}:
        if name not in files and was.get(name) != now.get(name):
            yield _named(step, f"{name} was {was.get(name)!r}, now {now.get(name)!r}")


def _wiring(step: Step, before: Mapping[str, Any]) -> Iterator[str]:
    def count(fed: Any) -> int:
        return len(fed) if isinstance(fed, list) else 1

    was = {port: count(fed) for port, fed in before["inputs"].items()}
    now = {
        port: len(fed.entries) if isinstance(fed, Gathered) else 1
        for port, fed in step.inputs.items()
    }
    for port in {**was, **now}:
        if was.get(port, 0) != now.get(port, 0):
            yield _named(step, f"{port} took {was.get(port, 0)} values, now {now.get(port, 0)}")


def _differences(before: Mapping[str, str], now: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    for name in {**before, **now}:
        if name not in before:
            yield name, "is new to it"
        elif name not in now:
            yield name, "is no longer part of it"
        elif before[name] != now[name]:
            yield name, "was edited"


def _named(step: Step, said: str) -> str:
    return f"{step.name}: {said}"


def _cell(node: str, labels: Mapping[str, Any]) -> _Cell:
    return node, tuple(sorted(labels.items()))
