"""The settings of a run: as data in its record, and as the options of a command."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

from pydantic import Field, Strict

from nodegraph.execute.events import plain
from nodegraph.execute.executor import HowToRun
from nodegraph.filenames import portable_name
from nodegraph.graph import Graph
from nodegraph.graph.option_text import labels_text, value_text
from nodegraph.plan import Step
from nodegraph.store import Store, store_folder

Int = Annotated[int, Strict()]
Float = Annotated[float, Strict()]
Bool = Annotated[bool, Strict()]
Label = Annotated[str | Int | Float | Bool, Field(union_mode="left_to_right")]

_DEFAULT = HowToRun()


@dataclass(frozen=True, slots=True)
class RunSettings:
    """The options that a run was started with.

    Attributes
    ----------
    graph : str
        The path of the graph file.
    set : dict of input to value
    axis : dict of axis to labels
        A list, a mapping of labels to values, or a generator.
    only : dict of axis to labels
    until : list of str
    plugins : list of str
        The paths of plugin files.
    store : str
        The folder of stored results; empty for the default.
    cache : bool
    executor : str
    jobs : int or None
    scheduler : str
    """

    graph: Annotated[str, Field(min_length=1)]
    set: dict[str, object] = field(default_factory=dict)
    axis: dict[str, object] = field(default_factory=dict)
    only: dict[str, list[Label]] = field(default_factory=dict)
    until: list[str] = field(default_factory=list)
    plugins: list[str] = field(default_factory=list)
    store: str = ""
    cache: Bool = True
    executor: str = _DEFAULT.executor
    jobs: Int | None = _DEFAULT.jobs
    scheduler: str = _DEFAULT.scheduler

    @property
    def command(self) -> str:
        """The command that runs the same again, quoted for a shell."""
        return shlex.join(["nodegraph", "run", self.graph, *self._options()])

    @property
    def chosen(self) -> str:
        """The options by which it has other inputs or labels than its file, quoted for a shell."""
        return shlex.join(self._choices())

    def repeat(self, step: Step) -> str:
        """Return the command that repeats one step; what feeds it comes from the store.

        It writes to a folder of its own, so that the run of the study stays where it is.
        """
        only = {**self.only, **{axis: [label] for axis, label in step.labels.items()}}
        alone = replace(self, only=only, until=[step.node]).command
        folder = portable_name(f"{Path(self.graph).stem}-{step.node}")
        return f"{alone} --out {shlex.quote(f'runs/{folder}')}"

    def _choices(self) -> Iterator[str]:
        for name, value in self.set.items():
            yield from ("--set", f"{name}={value_text(value)}")
        for name, labels in self.axis.items():
            yield from ("--axis", f"{name}={labels_text(labels)}")
        for name, labels in self.only.items():
            yield from ("--only", f"{name}={labels_text(labels)}")

    def _options(self) -> Iterator[str]:
        yield from self._choices()
        for node in self.until:
            yield from ("--until", node)
        for path in self.plugins:
            yield from ("--plugin", path)
        if self.store:
            yield from ("--store", self.store)
        # a node that ends its process, or cannot be sent to another, fails only where it ran
        if self.executor != _DEFAULT.executor:
            yield from ("--executor", self.executor)
        if self.scheduler:
            yield from ("--scheduler", self.scheduler)


def settings_of(graph: Graph, how: HowToRun, until: list[str], store: Store | None) -> RunSettings:
    """Return the settings with which a graph is run."""
    folder = graph.choices.folder.absolute()
    return RunSettings(
        graph=graph.spec.file,
        set=plain(graph.choices.inputs),
        axis=plain(graph.choices.axes),
        only=plain(graph.choices.only),
        until=until,
        plugins=[
            _path_from(folder, Path(plugin.module.__file__))
            for plugin in graph.registry.loaded
            if plugin.digest
        ],
        store=_store_text(folder, store),
        cache=store is not None,
        executor=how.executor,
        jobs=how.jobs,
        scheduler=how.scheduler,
    )


def _store_text(folder: Path, store: Store | None) -> str:
    if store is None or store.folder == store_folder().absolute():
        return ""
    return _path_from(folder, store.folder)


def _path_from(folder: Path, path: Path) -> str:
    return str(path.relative_to(folder) if path.is_relative_to(folder) else path)
