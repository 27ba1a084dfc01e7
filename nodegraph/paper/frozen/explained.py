"""What explains that a step's result is not the one in a lock."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from nodegraph.changes import settings_changed
from nodegraph.execute import Run
from nodegraph.paper.frozen.account import account, file_names, short_unit, units_of
from nodegraph.paper.frozen.lock import Lock
from nodegraph.paper.frozen.names import FileNames
from nodegraph.paper.frozen.results import Cell
from nodegraph.plan import Step

_AROUND_ALL = ("python", "platform")
"""Versions that every result may depend on."""


@dataclass(frozen=True)
class Change:
    """How a step is another than the one in a lock.

    Attributes
    ----------
    own : tuple of str
        What of the study itself is another: code of a method, settings, files, what feeds it.
    around : tuple of str
        What is another of what it stands on: versions of libraries, and of Python.
    """

    own: tuple[str, ...] = ()
    around: tuple[str, ...] = ()


class Explained:
    """Compares a run with the account in a lock.

    Parameters
    ----------
    lock
    run
        With a store, by which the code of its methods is known.
    """

    def __init__(self, lock: Lock, run: Run) -> None:
        self._was = lock.data
        self._run = run
        self._names = FileNames(run.plan.graph)
        self._now = account(run, self._names)

    def change(self, cell: Cell) -> Change:
        """Return how the step of a combination is another."""
        step = self._run.plan.steps[cell.index]
        was, now = (one["methods"].get(cell.group, {}) for one in (self._was, self._now))
        own = [
            *_used(was, now),
            *settings_changed(
                was.get("settings", {}), now.get("settings", {}), file_names(step, self._names)
            ),
            *self._axes(step),
            *self._files(step),
            *_fed(was.get("in", {}), now.get("in", {})),
            *self._code(step, was.get("code"), now.get("code")),
        ]
        return Change(tuple(own), tuple(self._versions(self._libraries(step))))

    def everywhere(self) -> Iterator[str]:
        """Yield what is another of the study as a whole: versions, and files' content."""
        yield from self._versions({**self._was["versions"], **self._now["versions"]})
        for name, digest in self._was["files"].items():
            if self._now["files"].get(name, digest) != digest:
                yield f"the content of {name} is another"

    @cached_property
    def same_syntax(self) -> bool:
        """Whether digests of code can be compared: each Python has a syntax of its own."""
        was, now = (one["versions"]["python"].split(".")[:2] for one in (self._was, self._now))
        return bool(was == now)

    def _axes(self, step: Step) -> Iterator[str]:
        for axis in step.labels:
            was, now = (one["axes"].get(axis) for one in (self._was, self._now))
            if was != now and isinstance(was, dict) and isinstance(now, dict):
                yield from (f"axis {axis}: {one}" for one in settings_changed(was, now))

    def _files(self, step: Step) -> Iterator[str]:
        was, now = self._was["files"], self._now["files"]
        for setting, name in file_names(step, self._names).items():
            known = [was[name]] if name in was else was.values()
            if now[name] not in known:
                yield f"{setting}: the content of {name} is another"

    def _code(self, step: Step, was: str | None, now: str | None) -> Iterator[str]:
        if was == now or not self.same_syntax:
            return
        edited = list(self._edited(step))
        yield from edited or ("its code was edited",)

    def _edited(self, step: Step) -> Iterator[str]:
        if self._run.recall is None:
            return
        for name, digest in self._run.recall.keys.fixed(step).reached.units.items():
            module, _, unit = name.partition(":")
            known = self._units.get(module, {}).get(unit or module)
            if known is None:
                yield f"code: {name} is new to it"
            elif known != short_unit(digest):
                yield f"code: {name} was edited"

    @cached_property
    def _units(self) -> Mapping[str, Mapping[str, str]]:
        return {module: units_of(line) for module, line in self._was["code"].items()}

    def _libraries(self, step: Step) -> Mapping[str, str]:
        recall = self._run.recall
        reached = recall.keys.fixed(step).reached.versions if recall is not None else {}
        return {**dict.fromkeys(_AROUND_ALL, ""), **reached}

    def _versions(self, names: Mapping[str, Any]) -> Iterator[str]:
        was, now = self._was["versions"], self._now["versions"]
        for name in names:
            if was.get(name) != now.get(name):
                yield f"{name} was {was.get(name, 'not used')}, now {now.get(name, 'not used')}"


def _used(was: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for name in ("use", "plugin"):
        if was and was.get(name) != now.get(name):
            yield f"{name} was {was.get(name)}, now {now.get(name)}"


def _fed(was: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    yield from (f"input {one}" for one in settings_changed(was, now))
