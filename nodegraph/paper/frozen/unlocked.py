"""A lock -> the graph that it froze, as far as what is installed here can run it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from nodegraph.errors import GraphError, NodegraphError, UnknownNodeError
from nodegraph.graph import Choices, Graph, build
from nodegraph.paper.frozen.lock import Lock
from nodegraph.registry import Registered, Registry
from nodegraph.spec import read_graph_text
from nodegraph.spec.parts import is_graph_file

_BUILT_IN = "pass"
_FAMILY = re.compile(r"(?<![\w.])([A-Za-z_]\w*)\.\*")


def unlocked(lock: Lock, registry: Registry, inputs: Mapping[str, Any]) -> Graph:
    """Return the graph of a lock: its text, choices and families, whatever there is by now.

    Parameters
    ----------
    lock
    registry
    inputs
        Values for inputs, in place of those in the lock.

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
        return build(spec, registry.without(_later(lock)), _choices(lock, inputs))
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
    """Yield how to name the files that are gone and that an input names."""
    for name, value in {**lock.data["inputs"], **inputs}.items():
        gone = f"no such file: {value}"
        if isinstance(value, str) and any(one.message.endswith(gone) for one in error.problems):
            yield f"where it lies by now: --set {name}=FILE"


def _later(lock: Lock) -> Callable[[Registered], bool]:
    """Return which nodes were no members yet of the families that the lock's graph expands."""
    text = "\n".join(lock.data["text"].values())
    families = set(_FAMILY.findall(text))
    used = {one["use"] for one in lock.data["methods"].values()}
    known = {str(one) for labels in lock.data["axes"].values() for one in labels}
    known |= {str(one) for labels in lock.data["removed"].values() for one in labels}

    def is_later(one: Registered) -> bool:
        if one.node.family not in families or one.node.name in used or one.node.name in text:
            return False
        return one.node.method not in known and f"{one.plugin}:{one.node.method}" not in known

    return is_later


def _choices(lock: Lock, inputs: Mapping[str, Any]) -> Choices:
    chosen = lock.data["choices"]
    return Choices(
        {**chosen.get("set", {}), **inputs},
        chosen.get("axis", {}),
        {name: tuple(labels) for name, labels in chosen.get("only", {}).items()},
        lock.graph.parent,
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
