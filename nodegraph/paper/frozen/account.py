"""What decides the results of a run, as plain data that means the same on another machine."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Any

from nodegraph.code import Reached
from nodegraph.display import labels_of
from nodegraph.execute import Run
from nodegraph.execute.events import plain
from nodegraph.execute.record import versions
from nodegraph.graph import Gather, GraphNode, Method
from nodegraph.paper.frozen.names import FileNames
from nodegraph.plan import Step
from nodegraph.spec.parts import Reference

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
    if run.recall is not None:
        for step in run.plan.steps:
            yield full_name(step.method), run.recall.keys.fixed(step).reached


def _versions(run: Run, reached: Mapping[str, Reached]) -> dict[str, str]:
    used = {name: one for code in reached.values() for name, one in code.versions.items()}
    found = {**used, **versions(run.plan.graph)}
    return dict(sorted(found.items(), key=lambda one: one[0].lower()))


def _files(run: Run, names: FileNames) -> Iterator[tuple[str, str]]:
    if run.recall is not None:
        for step in run.plan.steps:
            digests = run.recall.keys.fixed(step).files
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
