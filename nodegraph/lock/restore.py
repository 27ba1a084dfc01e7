"""A lock -> the graph that it froze, as far as what is installed here can run it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from nodegraph.errors import GraphError, NodegraphError, UnknownNodeError
from nodegraph.execute.step_cache import AUDITED
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.graphfile.spec import is_graph_file
from nodegraph.lock.lockfile import Lock
from nodegraph.plugin.registry import Registered, Registry
from nodegraph.store import Store

_BUILT_IN = "pass"
_FAMILY = re.compile(r"(?<![\w.])([A-Za-z_]\w*)\.\*")


def unlocked(lock: Lock, registry: Registry, inputs: Mapping[str, Any]) -> Graph:
    """Return the graph of a lock: its text, choices and families, whatever there is by now.

    Parameters
    ----------
    lock
    registry
    inputs
        Values for inputs, in place of those in the lock; relative paths among them start in the
        working directory.

    Raises
    ------
    NodegraphError
        If plugins are absent, or others than they were, such that the graph cannot be built; or
        a file is gone that it reads.
    """
    _refuse_absent(lock, registry)
    (_, text), *included = lock.data["text"].items()
    try:
        spec = read_graph_text(text, str(lock.graph), lock.graph.parent, dict(included))
        return build(spec, registry.without(_Met(lock, registry).is_later), _choices(lock, inputs))
    except GraphError as error:
        told = [f"the graph in {lock.path} cannot be run here:", str(error)]
        told += _moved(lock, error, inputs)
        told += [f"{one}, which may explain it" for one in _other_plugins(lock, registry)]
        raise NodegraphError("\n".join(told)) from error


def other_texts(lock: Lock) -> Iterator[str]:
    """Yield which graph files say something else than the lock, or are gone."""
    for name, text in lock.data["text"].items():
        path = lock.graph.parent / name
        try:
            if path.read_text(encoding="utf-8") != text:
                yield f"{path} has another text than the lock, whose text is verified"
        except (OSError, ValueError):
            yield f"{path} is gone; the text in the lock is verified"


def _moved(lock: Lock, error: GraphError, inputs: Mapping[str, Any]) -> Iterator[str]:
    """Yield where files were looked for that are gone, and how to name those of an input."""
    for name, value in {**lock.data["inputs"], **inputs}.items():
        gone = f"no such file: {value}"
        if isinstance(value, str) and any(one.message.endswith(gone) for one in error.problems):
            folder = Path.cwd() if name in inputs else lock.graph.parent.resolve()
            yield f"{value} was looked for in {folder}; where it lies by now: --set {name}=FILE"


class _Met:
    """Knows which nodes the graph of a lock met when it was locked."""

    def __init__(self, lock: Lock, registry: Registry) -> None:
        brought = [one for one in lock.data["methods"].values() if one.get("plugin")]
        labels = [*lock.data["axes"].values(), *lock.data["removed"].values()]
        self._text = "\n".join(lock.data["text"].values())
        self._families = set(_FAMILY.findall(self._text))
        self._names = {one["use"] for one in brought}
        self._full_names = {f"{one['plugin']}:{one['use']}" for one in brought}
        self._labels = {str(one) for several in labels for one in several}
        self._plugins = {one["plugin"] for one in brought}
        self._of_plugins = {one.node.name for one in registry if one.plugin in self._plugins}

    def is_later(self, one: Registered) -> bool:
        """Whether a node is a namesake of one of then, or has joined a family since."""
        name, label = one.node.name, f"{one.plugin}:{one.node.method}"
        if one.full_name in self._full_names or one.full_name in self._text:
            return False
        if label in self._labels:
            return False
        # a name that only its plugin had needs none before it in the text, nor as a label
        if name in self._names or (one.plugin not in self._plugins and name in self._of_plugins):
            return True
        joined = one.node.family in self._families and one.node.method not in self._labels
        return joined and name not in self._text


def _choices(lock: Lock, inputs: Mapping[str, Any]) -> Choices:
    chosen = lock.data["choices"]
    return Choices(
        {**chosen.get("set", {}), **inputs},
        chosen.get("axis", {}),
        {name: tuple(labels) for name, labels in chosen.get("only", {}).items()},
        lock.graph.parent,
        dict.fromkeys(inputs, Path.cwd()),
    )


def _refuse_absent(lock: Lock, registry: Registry) -> None:
    lacking: dict[str, list[str]] = {}
    for one in lock.data["methods"].values():
        name = f"{one['plugin']}:{one['use']}" if one.get("plugin") else one["use"]
        try:
            if one["use"] != _BUILT_IN and not is_graph_file(one["use"]):
                registry.find(name)
        except UnknownNodeError:
            nodes = lacking.setdefault(_brought(lock, registry, one), [])
            nodes += [one["use"]] if one["use"] not in nodes else []
    if lacking:
        lines = [f"{who}: {', '.join(nodes)}" for who, nodes in lacking.items()]
        raise NodegraphError("\n".join([f"{lock.path} needs what is not installed:", *lines]))


def _brought(lock: Lock, registry: Registry, method: Mapping[str, Any]) -> str:
    """Return who brought a method that is not there, and why it is not."""
    name, was = method.get("plugin", ""), method.get("from", "")
    there = next((one for one in registry.loaded if one.name == name), None)
    if there is not None:
        versions = f"{there.distribution} here and was {was}" if was else "there"
        return f"plugin {name} is {versions}, and has no such node"
    broken = next((one.reason for one in registry.broken if one.name == name), "")
    why = f"is left out ({broken})" if broken else "is absent"
    how = f"install {was}" if was else f"name the file that has it: --plugin {name}.py"
    return f"plugin {name} {why}; {how}"


def _other_plugins(lock: Lock, registry: Registry) -> Iterator[str]:
    """Yield each plugin that is not of the version that it was."""
    here = {one.name: one.distribution for one in registry.loaded}
    methods = [one for one in lock.data["methods"].values() if one.get("plugin")]
    for name, was in {one["plugin"]: one.get("from", "") for one in methods}.items():
        if here.get(name, was) != was:
            yield f"plugin {name} is {here[name]} here and was {was}"


class Afresh(Store):
    """A store without results, which knows what audits found as another one does.

    Parameters
    ----------
    folder
        An empty one.
    known
        Knows what audits found.
    say
        As that of any store.
    """

    def __init__(self, folder: Path, known: Store, say: Callable[[str], None]) -> None:
        super().__init__(folder, known.packer, say)
        self._known = known

    def recall(self, name: str) -> dict[str, Any]:
        """Return what was remembered here; of audits, there."""
        return self._known.recall(name) if name.startswith(AUDITED) else super().recall(name)
