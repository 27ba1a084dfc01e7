"""Everything that decides the results of a run, under names valid on other machines."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from nodegraph.cache_key import UNKNOWN, Reached
from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.execute.events import plain
from nodegraph.formatting import labels_of
from nodegraph.graph import Gather, Graph, GraphNode, Method
from nodegraph.graphfile.spec import Reference
from nodegraph.lock.document import LockedMethod, Provenance
from nodegraph.plan import Step
from nodegraph.plugin.registry import Registry
from nodegraph.runs.record import versions

_LONGEST = 200
"""Characters of a line in a message."""

_DIGITS = 10


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
        from_command = set(_texts([graph.choices.inputs, graph.choices.axes]))
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

    def of(self, written: str, path: Path) -> str:
        """Return the name of a file with this path, which is written like this in the graph."""
        return written if self._registry.hooks.is_place(written) else relative(path, self._folder)

    def portable(self, value: object) -> Any:
        """Return plain data with the paths of files replaced by their names."""
        if isinstance(value, Mapping):
            return {key: self.portable(item) for key, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [self.portable(item) for item in value]
        return self._names.get(value, value) if isinstance(value, str) else value

    def _add(self, setting: str, written: str, path: Path, from_command: set[str]) -> None:
        if _is_absolute(written) and written not in from_command:
            raise NodegraphError(
                f"{setting}: {written} is a path of this machine, which a lock must not hold; "
                "write it relative to the graph file, or pass it with --set INPUT=PATH, or with "
                "--axis 'AXIS={label: PATH, ...}'"
            )
        self._names[written] = self.of(written, path)


def _files_of(node: str, method: Method) -> Iterator[tuple[str, str, Path]]:
    """Yield the setting that names a file, the name as written, and its path."""
    files = [name for name, setting in method.node.settings.items() if setting.is_file]
    for name in files:
        for labels, shown in method.settings.shown.items():
            path = method.settings.values[labels].get(name)
            if path is not None:
                yield f"{node}: {name}", str(shown[name]), Path(path)


def _texts(value: object) -> Iterator[str]:
    pending = [value]
    while pending:
        item = pending.pop()
        if isinstance(item, Mapping):
            pending.extend(item.values())
        elif isinstance(item, (list, tuple)):
            pending.extend(item)
        elif isinstance(item, str):
            yield item


def _is_absolute(text: str) -> bool:
    if PureWindowsPath(text).drive and PureWindowsPath(text).is_absolute():
        return True
    return PurePosixPath(text).is_absolute() and len(PurePosixPath(text).parts) > 1


def provenance(run: Run, names: FileNames) -> Provenance:
    """Return everything that decided the results of a run."""
    graph = run.plan.graph
    reached = dict(_reached(run))
    return Provenance(
        versions=_versions(run, reached),
        inputs=names.portable(plain(graph.inputs)),
        axes={
            name: names.portable(
                {str(label): plain(axis.values.get(label, label)) for label in axis.labels}
                if any(value != label for label, value in axis.values.items())
                else list(axis.labels)
            )
            for name, axis in graph.axes.items()
        },
        removed={
            name: sorted(axis.removed, key=str) for name, axis in graph.axes.items() if axis.removed
        },
        files=dict(sorted(_files(run, names))),
        methods={
            group_name(node, method): _method(node, method, reached, names)
            for node in graph.nodes.values()
            for method in node.methods.values()
        },
        code={
            name: digest[:_DIGITS]
            for code in reached.values()
            for name, digest in code.units.items()
        },
    )


def group_name(node: GraphNode, method: Method) -> str:
    """Return the name of a method in a lock: the node, or node and alternative."""
    return f"{node.name}={method.label}" if node.has_alternatives else node.name


def full_name(method: Method) -> str:
    """Return the name of a method with its plugin."""
    return f"{method.plugin}:{method.node.name}"


def file_names(step: Step, names: FileNames) -> dict[str, str]:
    """Return the names of the files that a step reads, by setting."""
    return {
        name: names.of(str(step.shown[name]), step.settings[name])
        for name, setting in step.method.node.settings.items()
        if setting.is_file and step.settings.get(name) is not None
    }


def code_digest(reached: Reached) -> str:
    """Return a digest of all code that a method reaches."""
    return hashlib.sha256(repr(sorted(reached.units.items())).encode()).hexdigest()[:_DIGITS]


def _reached(run: Run) -> Iterator[tuple[str, Reached]]:
    if run.cache is not None:
        for step in run.plan.steps:
            yield full_name(step.method), run.cache.digest_of(step).code


def _versions(run: Run, reached: Mapping[str, Reached]) -> dict[str, str]:
    by_name: dict[str, str] = {}
    for code in reached.values():
        by_name |= code.versions
    by_name |= versions(run.plan.graph)
    installed = {name for name, version in by_name.items() if version != UNKNOWN}
    return {name: by_name[name] for name in sorted(installed, key=str.lower)}


def _files(run: Run, names: FileNames) -> Iterator[tuple[str, str]]:
    if run.cache is not None:
        for step in run.plan.steps:
            digests = run.cache.digest_of(step).files
            for setting, name in file_names(step, names).items():
                yield name, digests.get(setting, "")[: 2 * _DIGITS]


def _method(
    node: GraphNode, method: Method, reached: Mapping[str, Reached], names: FileNames
) -> LockedMethod:
    code = reached.get(full_name(method))
    return LockedMethod(
        use=method.node.name,
        plugin=method.plugin,
        distribution=method.distribution,
        code=code_digest(code) if code is not None else "",
        axes=list(node.axes),
        gathers=list(node.gathered),
        inputs={port: _source_text(source) for port, source in method.inputs.items()},
        settings={name: _setting(method, name, names) for name in method.node.settings},
    )


def _setting(method: Method, name: str, names: FileNames) -> object:
    """Return a setting's value, or its values by the labels that it depends on."""
    by_labels = {
        ", ".join(map(str, labels)): names.portable(plain(shown.get(name)))
        for labels, shown in method.settings.shown.items()
    }
    values = list(by_labels.values())
    if all(value == values[0] for value in values):
        return values[0] if values else None
    axis = next((axis for axis in method.settings.axes if _is_label(method, name, axis)), None)
    return f"${axis}" if axis is not None else by_labels


def _is_label(method: Method, name: str, axis: str) -> bool:
    place = method.settings.axes.index(axis)
    return all(shown.get(name) == labels[place] for labels, shown in method.settings.shown.items())


def _source_text(feed: Reference | Gather) -> str | dict[str, str]:
    if isinstance(feed, Reference):
        return f"{feed} at {labels_of(feed.at)}" if feed.at else str(feed)
    texts = {label: str(_source_text(source)) for label, source in feed.sources.items()}
    return texts if feed.axis else texts[""]
