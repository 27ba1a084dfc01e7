"""Changes of the steps of a run since its study was locked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from nodegraph.execute import Run
from nodegraph.lock.document import LockedMethod, LockedStudy
from nodegraph.lock.provenance import FileNames, file_names, provenance
from nodegraph.lock.results import Cell
from nodegraph.plan import Step
from nodegraph.runs.changes import setting_changes

_AROUND_ALL = ("python", "platform")
"""Versions on which every result may depend."""


@dataclass(frozen=True)
class Change:
    """The changes of one step.

    Attributes
    ----------
    own : tuple of str
        Changes of the study itself: code, settings, files, and what feeds the step.
    around : tuple of str
        Changes of its environment: versions of libraries and of Python.
    """

    own: tuple[str, ...] = ()
    around: tuple[str, ...] = ()


class Changes:
    """The changes of a run since a study was locked.

    Parameters
    ----------
    study
    run
        With a store, which has the digests of code.
    """

    def __init__(self, study: LockedStudy, run: Run) -> None:
        self._was = study
        self._run = run
        self._names = FileNames(run.plan.graph)
        self._now = provenance(run, self._names)

    def of(self, cell: Cell) -> Change:
        """Return how the step of a combination changed."""
        step = self._run.plan.steps[cell.index]
        was, now = self._was.methods[cell.group], self._now.methods[cell.group]
        own = [
            *_method_changes(was, now),
            *setting_changes(was.settings, now.settings, file_names(step, self._names)),
            *self._axes(step),
            *self._files(step),
            *(f"input {text}" for text in setting_changes(was.inputs, now.inputs)),
            *self._code(step, was.code, now.code),
        ]
        return Change(tuple(own), tuple(self._versions(self._libraries(step))))

    def everywhere(self) -> Iterator[str]:
        """Yield the changes of the study as a whole: of versions, code and the content of files."""
        pairs = [(was.code, self._now.methods.get(name)) for name, was in self._was.methods.items()]
        edited = sum(now is not None and now.code != code for code, now in pairs)
        if edited and self.same_syntax:
            yield f"the code digests of {edited} of {len(pairs)} methods differ"
        yield from self._versions({**self._was.versions, **self._now.versions})
        for name, digest in self._was.files.items():
            if self._now.files.get(name, digest) != digest:
                yield f"the content of {name} changed"

    @cached_property
    def same_syntax(self) -> bool:
        """Whether digests of code can be compared: they depend on the version of Python."""
        was, now = (origin.versions["python"].split(".")[:2] for origin in (self._was, self._now))
        return was == now

    def _axes(self, step: Step) -> Iterator[str]:
        for axis in step.labels:
            was, now = self._was.axes.get(axis), self._now.axes.get(axis)
            if was != now and isinstance(was, dict) and isinstance(now, dict):
                yield from (f"axis {axis}: {text}" for text in setting_changes(was, now))

    def _files(self, step: Step) -> Iterator[str]:
        was, now = self._was.files, self._now.files
        for setting, name in file_names(step, self._names).items():
            known = [was[name]] if name in was else was.values()
            if now[name] not in known:
                yield f"{setting}: the content of {name} changed"

    def _code(self, step: Step, was: str, now: str) -> Iterator[str]:
        if was != now and self.same_syntax:
            edited = list(self._edited(step))
            yield from edited or ("its code was edited",)

    def _edited(self, step: Step) -> Iterator[str]:
        if self._run.cache is None:
            return
        for name in self._run.cache.digest_of(step).code.units:
            known = self._was.code.get(name)
            if known is None:
                yield f"code: {name} was not used before"
            elif known != self._now.code[name]:
                yield f"code: {name} has another digest"

    def _libraries(self, step: Step) -> Mapping[str, str]:
        cache = self._run.cache
        reached = cache.digest_of(step).code.versions if cache is not None else {}
        return {**dict.fromkeys(_AROUND_ALL, ""), **reached}

    def _versions(self, names: Mapping[str, str]) -> Iterator[str]:
        was, now = self._was.versions, self._now.versions
        for name in names:
            if was.get(name) != now.get(name):
                yield f"{name} was {was.get(name, 'not used')}, now {now.get(name, 'not used')}"


def _method_changes(was: LockedMethod, now: LockedMethod) -> Iterator[str]:
    if was.use != now.use:
        yield f"use was {was.use}, now {now.use}"
    if was.plugin != now.plugin:
        yield f"plugin was {was.plugin or None}, now {now.plugin or None}"
