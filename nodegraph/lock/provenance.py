"""What decides the results of a run, as plain data that means the same on another machine."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.execute import Run
from nodegraph.execute.events import plain
from nodegraph.fingerprint import Reached
from nodegraph.formatting import labels_of
from nodegraph.graph import Gather, Graph, GraphNode, Method
from nodegraph.graphfile.spec import Reference
from nodegraph.plan import Step
from nodegraph.plugin.registry import Registry
from nodegraph.runs.record import versions

_SHOWN = 200
"""Letters of a line in a message."""


def relative(path: Path, folder: Path) -> str:
    """Return a path as seen from a folder, or its last name where the two have little in common.

    What two users' folders, or two disks, have in common says where somebody works, and no more.
    """
    path, folder = path.resolve(), folder.resolve()
    try:
        common = Path(os.path.commonpath([path, folder]))
    except ValueError:  # on two drives
        return path.name
    above_users = Path.home().resolve().parent
    if common == Path(common.anchor) or above_users.is_relative_to(common):
        return path.name
    return Path(os.path.relpath(path, folder)).as_posix()


def refuse_paths(text: str, folders: Iterable[Path]) -> None:
    """Refuse a text that says where something lies in one of the folders.

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
                f"the lock would hold the path {inside} of this machine: {line.strip()[:_SHOWN]}"
            )


class FileNames:
    """What the files that a graph's settings name are called in a lock.

    Parameters
    ----------
    graph

    Raises
    ------
    NodegraphError
        If the graph itself names one by where it lies on this machine, or a label is a path.
    """

    def __init__(self, graph: Graph) -> None:
        self._registry: Registry = graph.registry
        self._folder = graph.spec.folder
        self._given: dict[str, str] = {}
        chosen = set(_texts([graph.choices.inputs, graph.choices.axes]))
        for node in graph.nodes.values():
            for method in node.methods.values():
                for where, written, path in _files_of(node.name, method):
                    self._note(where, written, path, chosen)
        for axis in graph.axes.values():
            for label in axis.labels:
                if _is_absolute(str(label)):
                    raise NodegraphError(
                        f"axis {axis.name}: the label {label} is a path of this machine, which a "
                        "lock must not hold; give the axis names: {name: path}"
                    )

    def of(self, written: str, path: Path) -> str:
        """Return the name of a file that lies at `path`, and was written so."""
        return written if self._registry.hooks.place(written) else relative(path, self._folder)

    def portable(self, value: Any) -> Any:
        """Return plain data in which the files that settings name have those names."""
        if isinstance(value, Mapping):
            return {key: self.portable(one) for key, one in value.items()}
        if isinstance(value, (list, tuple)):
            return [self.portable(one) for one in value]
        return self._given.get(value, value) if isinstance(value, str) else value

    def _note(self, where: str, written: str, path: Path, chosen: set[str]) -> None:
        if _is_absolute(written) and written not in chosen:
            raise NodegraphError(
                f"{where}: {written} is a path of this machine, which a lock must not hold; write "
                "it as seen from the graph file, or give it with --set"
            )
        self._given[written] = self.of(written, path)


def _files_of(node: str, method: Method) -> Iterator[tuple[str, str, Path]]:
    """Yield where a file is named, how it is written, and where it lies."""
    files = [name for name, one in method.node.settings.items() if one.is_file]
    for name in files:
        for labels, shown in method.settings.shown.items():
            path = method.settings.values[labels].get(name)
            if path is not None:
                yield f"{node}: {name}", str(shown[name]), Path(path)


def _texts(value: Any) -> Iterator[str]:
    pending = [value]
    while pending:
        one = pending.pop()
        if isinstance(one, Mapping):
            pending.extend(one.values())
        elif isinstance(one, (list, tuple)):
            pending.extend(one)
        elif isinstance(one, str):
            yield one


def _is_absolute(text: str) -> bool:
    if PureWindowsPath(text).drive and PureWindowsPath(text).is_absolute():
        return True
    return PurePosixPath(text).is_absolute() and len(PurePosixPath(text).parts) > 1


_DIGITS = 10
_OF_A_UNIT = 4
"""Letters that tell one function of a module from its edited self, where all else says "edited"."""


def account(run: Run, names: FileNames) -> dict[str, Any]:
    """Return what a run was made of.

    Returns
    -------
    dict
        ``versions`` of libraries; ``inputs`` and ``axes`` of the graph, with the labels that the
        command has ``removed``; ``methods``, by node and
        alternative, each with what feeds it, its settings and the digest of its code; ``code``, a
        line per module; ``files`` with the digests of their content.
    """
    graph = run.plan.graph
    reached = dict(_reached(run))
    return {
        "versions": _versions(run, reached),
        "inputs": names.portable(plain(graph.inputs)),
        "axes": {
            name: names.portable(
                {str(label): plain(axis.values.get(label, label)) for label in axis.labels}
                if any(value != label for label, value in axis.values.items())
                else list(axis.labels)
            )
            for name, axis in graph.axes.items()
        },
        "removed": {
            name: sorted(axis.removed, key=str) for name, axis in graph.axes.items() if axis.removed
        },
        "files": dict(sorted(_files(run, names))),
        "methods": {
            group_name(node, method): _method(node, method, reached, names)
            for node in graph.nodes.values()
            for method in node.methods.values()
        },
        "code": _modules(reached),
    }


def group_name(node: GraphNode, method: Method) -> str:
    """Return the name of a method in a lock: the node, or node and alternative."""
    return f"{node.name}={method.label}" if node.has_alternatives else node.name


def full_name(method: Method) -> str:
    """Return the name of a method that says who brought it."""
    return f"{method.plugin}:{method.node.name}"


def file_names(step: Step, names: FileNames) -> dict[str, str]:
    """Return the names of the files that a step reads, by setting."""
    return {
        name: names.of(str(step.shown[name]), step.settings[name])
        for name, one in step.method.node.settings.items()
        if one.is_file and step.settings.get(name) is not None
    }


def code_digest(reached: Reached) -> str:
    """Return one digest of all code that a method reaches."""
    return hashlib.sha256(repr(sorted(reached.units.items())).encode()).hexdigest()[:_DIGITS]


def units_of(line: str) -> dict[str, str]:
    """Return the digests of a module's functions from its line."""
    return dict(one.rsplit(" ", 1) for one in line.split(", ") if " " in one)


def short_unit(digest: str) -> str:
    """Return what the line of a module has of the digest of one function."""
    return digest[:_OF_A_UNIT]


def _reached(run: Run) -> Iterator[tuple[str, Reached]]:
    if run.cache is not None:
        for step in run.plan.steps:
            yield full_name(step.method), run.cache.digest_of(step).code


def _versions(run: Run, reached: Mapping[str, Reached]) -> dict[str, str]:
    used = {name: one for code in reached.values() for name, one in code.versions.items()}
    found = {**used, **versions(run.plan.graph)}
    return dict(sorted(found.items(), key=lambda one: one[0].lower()))


def _files(run: Run, names: FileNames) -> Iterator[tuple[str, str]]:
    if run.cache is not None:
        for step in run.plan.steps:
            digests = run.cache.digest_of(step).files
            for setting, name in file_names(step, names).items():
                yield name, digests.get(setting, "")[: 2 * _DIGITS]


def _method(
    node: GraphNode, method: Method, reached: Mapping[str, Reached], names: FileNames
) -> dict[str, Any]:
    fed = {port: _source(one) for port, one in method.inputs.items()}
    code = reached.get(full_name(method))
    said = {
        "use": method.node.name,
        "plugin": method.plugin,
        "from": method.distribution,
        "code": code_digest(code) if code is not None else "",
        "axes": list(node.axes),
        "gathers": list(node.gathered),
        "in": fed,
        "settings": {name: _setting(method, name, names) for name in method.node.settings},
    }
    return {name: one for name, one in said.items() if one}


def _setting(method: Method, name: str, names: FileNames) -> Any:
    """Return a setting's value, or its values by the labels that it depends on."""
    found = {
        ", ".join(map(str, labels)): names.portable(plain(shown.get(name)))
        for labels, shown in method.settings.shown.items()
    }
    values = list(found.values())
    if all(one == values[0] for one in values):
        return values[0] if values else None
    axis = next((axis for axis in method.settings.axes if _is_label(method, name, axis)), None)
    return f"${axis}" if axis is not None else found


def _is_label(method: Method, name: str, axis: str) -> bool:
    place = method.settings.axes.index(axis)
    return all(shown.get(name) == labels[place] for labels, shown in method.settings.shown.items())


def _source(fed: Reference | Gather) -> Any:
    if isinstance(fed, Reference):
        return _reference(fed)
    if not fed.axis:
        return _reference(fed.sources[""])
    return {label: _reference(one) for label, one in fed.sources.items()}


def _reference(one: Reference) -> str:
    return f"{one} at {labels_of(one.at)}" if one.at else str(one)


def _modules(reached: Mapping[str, Reached]) -> dict[str, str]:
    """Return the functions, classes and constants of each module with their digests, in a line."""
    units = {name: one for code in reached.values() for name, one in code.units.items()}
    modules: dict[str, list[str]] = {}
    for name, digest in sorted(units.items()):
        module, _, unit = name.partition(":")
        modules.setdefault(module, []).append(f"{unit or module} {short_unit(digest)}")
    return {module: ", ".join(lines) for module, lines in modules.items()}
