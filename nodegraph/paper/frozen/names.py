"""Names of files that mean the same on another machine."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.graph import Graph, Method
from nodegraph.registry import Registry

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
        return written if self._registry.place(written) else relative(path, self._folder)

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
