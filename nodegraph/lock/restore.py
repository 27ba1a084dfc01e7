"""Build the graph of a lock from what is installed."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from nodegraph.errors import GraphError, NodegraphError, UnknownNodeError
from nodegraph.execute.resume import AUDITED
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.graphfile.keys import PASS
from nodegraph.graphfile.spec import is_graph_file
from nodegraph.lock.lockfile import Lock
from nodegraph.plugin.registry import Registered, Registry
from nodegraph.runs.record import RecordedMethod
from nodegraph.store import Store

_FAMILY = re.compile(r"(?<![\w.])([A-Za-z_]\w*)\.\*")


def unlocked(lock: Lock, path: Path, registry: Registry, inputs: Mapping[str, object]) -> Graph:
    """Return the graph of a lock: its text and choices, without nodes that were added later.

    Parameters
    ----------
    lock, path
        A lock and its file.
    registry
    inputs
        Values that replace inputs of the lock; relative paths start in the working directory.

    Raises
    ------
    NodegraphError
        If plugins are missing or of other versions, such that the graph cannot be built, or if
        a file that it reads is missing.
    """
    _refuse_missing(lock, path, registry)
    (_, text), *included = lock.text.items()
    file = lock.graph(path)
    try:
        spec = read_graph_text(text, str(file), file.parent, dict(included))
        then = registry.without(_LockedNames(lock, registry).is_later)
        return build(spec, then, _choices(lock, file.parent, inputs))
    except GraphError as error:
        lines = [f"the graph in {path} cannot be run:", str(error)]
        lines += _missing_files(lock, file.parent, error, inputs)
        lines += [f"{text}, which may explain it" for text in _other_versions(lock, registry)]
        raise NodegraphError("\n".join(lines)) from error


def edited_files(lock: Lock, path: Path) -> Iterator[str]:
    """Yield a text per graph file that is missing or not as in the lock of this path."""
    for name, text in lock.text.items():
        file = lock.graph(path).parent / name
        try:
            if file.read_text(encoding="utf-8") != text:
                yield f"{file} was edited; the text in the lock is verified"
        except (OSError, ValueError):
            yield f"{file} is missing; the text in the lock is verified"


def _missing_files(
    lock: Lock, folder: Path, error: GraphError, inputs: Mapping[str, object]
) -> Iterator[str]:
    """Yield where missing files of inputs were looked for, and how to pass their new paths."""
    for name, value in {**lock.record.inputs, **inputs}.items():
        ending = f"no such file: {value}"
        if isinstance(value, str) and any(p.message.endswith(ending) for p in error.problems):
            place = Path.cwd() if name in inputs else folder.resolve()
            yield f"{value} was looked for in {place}; pass its path with --set {name}=FILE"


def _methods(lock: Lock) -> Iterator[RecordedMethod]:
    return (method for node in lock.record.nodes.values() for method in node.methods.values())


class _LockedNames:
    """The names that the graph of a lock could use when it was locked."""

    def __init__(self, lock: Lock, registry: Registry) -> None:
        methods = [method for method in _methods(lock) if method.plugin]
        labels = [*lock.record.axes.values(), *lock.record.removed.values()]
        self._text = "\n".join(lock.text.values())
        self._families = set(_FAMILY.findall(self._text))
        self._names = {method.use for method in methods}
        self._full_names = {method.full_name for method in methods}
        self._labels = {str(label) for axis in labels for label in axis}
        self._plugins = {method.plugin for method in methods}
        self._of_plugins = {node.node.name for node in registry if node.plugin in self._plugins}

    def is_later(self, node: Registered) -> bool:
        """Return whether a node has the name of a locked one, or joined a family later."""
        name, label = node.node.name, f"{node.plugin}:{node.node.method}"
        if node.full_name in self._full_names or node.full_name in self._text:
            return False
        if label in self._labels:
            return False
        # a name that only one plugin defined is written without the plugin in text and labels
        if name in self._names or (node.plugin not in self._plugins and name in self._of_plugins):
            return True
        in_family = node.node.family in self._families and node.node.method not in self._labels
        return in_family and name not in self._text


def _choices(lock: Lock, folder: Path, inputs: Mapping[str, object]) -> Choices:
    choices = lock.record.settings
    return Choices(
        {**choices.set, **inputs},
        choices.axis,
        {name: tuple(labels) for name, labels in choices.only.items()},
        folder,
        dict.fromkeys(inputs, Path.cwd()),
    )


def _refuse_missing(lock: Lock, path: Path, registry: Registry) -> None:
    """Raise an error with the nodes of the lock that are not installed, by plugin."""
    by_reason: dict[str, list[str]] = {}
    for method in _methods(lock):
        try:
            if method.use != PASS and not is_graph_file(method.use):
                registry.find(method.full_name)
        except UnknownNodeError:
            nodes = by_reason.setdefault(_reason(registry, method), [])
            nodes += [method.use] if method.use not in nodes else []
    if by_reason:
        lines = [f"{reason}: {', '.join(nodes)}" for reason, nodes in by_reason.items()]
        raise NodegraphError("\n".join([f"{path} needs what is not installed:", *lines]))


def _reason(registry: Registry, method: RecordedMethod) -> str:
    """Return why a node is missing, and what to install."""
    name, was = method.plugin, method.distribution
    plugin = next((plugin for plugin in registry.loaded if plugin.name == name), None)
    if plugin is not None:
        versions = f" is {plugin.distribution} here and was {was}, and" if was else ""
        return f"plugin {name}{versions} has no such node"
    broken = next((plugin.reason for plugin in registry.broken if plugin.name == name), "")
    why = f"is left out ({broken})" if broken else "is missing"
    how = f"install {was}" if was else f"name the file that has it: --plugin {name}.py"
    return f"plugin {name} {why}; {how}"


def _other_versions(lock: Lock, registry: Registry) -> Iterator[str]:
    """Yield a text per plugin of another version."""
    loaded = {plugin.name: plugin.distribution for plugin in registry.loaded}
    for name, was in {method.plugin: method.distribution for method in _methods(lock)}.items():
        if loaded.get(name, was) != was:
            yield f"plugin {name} is {loaded[name]} here and was {was}"


class StoreWithoutResults(Store):
    """An empty store that has the audits of another store.

    Parameters
    ----------
    folder
        An empty one.
    audits
        The store with the audits.
    say
        As for any store.
    """

    def __init__(self, folder: Path, audits: Store, say: Callable[[str], None]) -> None:
        super().__init__(folder, audits.packer, say)
        self._audits = audits

    def recall(self, name: str) -> dict[str, object]:
        """Return the record of this name; that of an audit from the other store."""
        return self._audits.recall(name) if name.startswith(AUDITED) else super().recall(name)
