"""The record of a run without what is of one machine: paths, times, and keys of a store."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.execute.results import Run
from nodegraph.execute.settings import RunSettings
from nodegraph.graph import Graph, Method
from nodegraph.graphfile.spec import leaves, with_names
from nodegraph.lock.results import Results
from nodegraph.plugin.registry import Registry
from nodegraph.runs.record import Record, RecordedStep, record
from nodegraph.state import State

_LONGEST = 200
"""Characters of a line in a message."""

_DIGITS = 10
"""Digits of the digests of results."""

_FOLDERS = re.compile(r"(?<![\w.:/\\])(?:[A-Za-z]:)?[/\\](?:[^\s:'\"/\\]+[/\\])+")


def portable(run: Run, names: FileNames, results: Results) -> Record:
    """Return the record of a run as it would be on another machine, with its digests.

    It has no sources of steps: the graph decides them.

    Parameters
    ----------
    run, names
    results
        The results of the run.
    """
    full = record(run)
    choices = run.plan.graph.choices
    return replace(
        full,
        command="",
        settings=RunSettings(
            run.plan.graph.spec.file,
            set=names.portable(full.settings.set),
            axis={name: _axis(value, names) for name, value in choices.axes.items()},
            only=full.settings.only,
        ),
        folder=".",
        plugins=[],
        inputs=names.portable(full.inputs),
        counts={},
        seconds=0.0,
        notices=[],
        steps=[_portable_step(step, names, results) for step in full.steps],
    )


def _portable_step(step: RecordedStep, names: FileNames, results: Results) -> RecordedStep:
    digests = results.digests(step.step) if step.has_result else ()
    # the message of a failure may depend on the machine
    reason = _FOLDERS.sub("", step.reason) if step.state is State.REFUSED else ""
    return replace(
        step,
        settings=names.portable(step.settings),
        state=State.DONE if step.has_result else step.state,
        seconds=0.0,
        stored=False,
        reason=" ".join(reason.split()),
        place="",
        trace="",
        warnings=[],
        digests=[digest[:_DIGITS] for digest in digests],
        repeat="",
    )


def _axis(value: object, names: FileNames) -> object:
    """Return the value of an axis, with the same labels though their files are renamed."""
    renamed = names.portable(value)
    if isinstance(value, list) and renamed != value:
        return dict(zip(map(str, value), renamed, strict=True))
    return renamed


def relative(path: Path, folder: Path) -> str:
    """Return a path relative to a folder, or only its name where they share no folder of the user.

    A path through the folders above would depend on the machine.
    """
    path, folder = path.resolve(), folder.resolve()
    try:
        common = Path(os.path.commonpath([path, folder]))
    except ValueError:  # on different drives
        return path.name
    above_users = Path.home().resolve().parent
    if common == Path(common.anchor) or above_users.is_relative_to(common):
        return path.name
    return Path(os.path.relpath(path, folder)).as_posix()


def refuse_paths(text: str, folders: Iterable[Path]) -> None:
    """Raise an error if a text contains a path below one of the folders.

    Raises
    ------
    NodegraphError
        With the line.
    """
    for folder in folders:
        inside = f"{folder.resolve()}{os.sep}"
        line = next((line for line in text.splitlines() if inside in line), "")
        if line and folder.resolve().parent != folder.resolve():
            raise NodegraphError(
                f"the lock would hold the path {inside} of this machine: {line.strip()[:_LONGEST]}"
            )


class FileNames:
    """The names in a lock of the files that the settings of a graph name.

    Raises
    ------
    NodegraphError
        If the graph itself contains an absolute path.
    """

    def __init__(self, graph: Graph) -> None:
        self._registry: Registry = graph.registry
        self._folder = graph.spec.folder
        self._names: dict[str, str] = {}
        from_command = set(texts_in([graph.choices.inputs, graph.choices.axes]))
        for node in graph.nodes.values():
            for method in node.methods.values():
                for setting, written, path in _files_of(node.name, method):
                    self._add(setting, written, path, from_command)
        for axis in graph.axes.values():
            for label in axis.labels:
                if _is_absolute(str(label)):
                    raise NodegraphError(
                        f"axis {axis.name}: the label {label} is a path of this machine, which a "
                        "lock must not hold; give the paths labels: {label: path, ...}, in the "
                        "graph or with --axis"
                    )

    def portable(self, value: object) -> Any:
        """Return plain data with the paths of files replaced by their names."""
        return with_names(value, self._names)

    def _add(self, setting: str, written: str, path: Path, from_command: set[str]) -> None:
        if _is_absolute(written) and written not in from_command:
            raise NodegraphError(
                f"{setting}: {written} is a path of this machine, which a lock must not hold; "
                "write it relative to the graph file, or pass it with --set INPUT=PATH, or with "
                "--axis 'AXIS={label: PATH, ...}'"
            )
        is_place = self._registry.hooks.is_place(written)
        self._names[written] = written if is_place else relative(path, self._folder)


def _files_of(node: str, method: Method) -> Iterator[tuple[str, str, Path]]:
    """Yield the setting that names a file, the name as written, and its path."""
    files = [name for name, setting in method.node.settings.items() if setting.is_file]
    for name in files:
        for labels, shown in method.settings.shown.items():
            path = method.settings.values[labels].get(name)
            if path is not None:
                yield f"{node}: {name}", str(shown[name]), Path(path)


def texts_in(value: object) -> Iterator[str]:
    """Yield the texts inside plain data."""
    return (part for part in leaves(value) if isinstance(part, str))


def _is_absolute(text: str) -> bool:
    if PureWindowsPath(text).drive and PureWindowsPath(text).is_absolute():
        return True
    return PurePosixPath(text).is_absolute() and len(PurePosixPath(text).parts) > 1
