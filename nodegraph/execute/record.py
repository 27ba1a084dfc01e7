"""A run as plain data, for ``run.json``: what ran, with which settings, how it ended."""

from __future__ import annotations

import platform
import shlex
import sys
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from nodegraph.execute.call import Outcome
from nodegraph.execute.events import plain
from nodegraph.execute.left_out import left_out
from nodegraph.execute.results import Run
from nodegraph.graph import Graph, GraphNode
from nodegraph.plan import Output, Step, StepInput

FORMAT = 1
_LIBRARIES = ("nodegraph", "numpy", "scipy", "pandas", "numba", "scikit-learn", "matplotlib")


def record(run: Run, command: str) -> dict[str, Any]:
    """Return everything about a run but its values; `command` runs it again."""
    graph = run.plan.graph
    return {
        "format": FORMAT,
        "command": command,
        "folder": str(graph.choices.folder.absolute()),
        "plugins": _plugin_files(graph),
        "title": graph.title,
        "included": dict(graph.spec.included),
        "inputs": plain(graph.inputs),
        "axes": {name: list(axis.labels) for name, axis in graph.axes.items()},
        "nodes": {name: _node(node) for name, node in graph.nodes.items()},
        "code": _code(run),
        "known": [str(one) for one in graph.spec.known],
        "left_out": [{"node": one, "reason": why} for one, why in left_out(graph).items()],
        "counts": run.counts(),
        "seconds": round(run.seconds, 6),
        "not_kept": dict(run.recall.not_kept) if run.recall else {},
        "steps": _steps(run, command),
        "skipped": _skipped(run),
        "versions": versions(graph),
    }


def versions(graph: Graph) -> dict[str, str]:
    """Return the versions of Python, of the libraries and of the plugins that took part."""
    plugins = {
        method.distribution for node in graph.nodes.values() for method in node.methods.values()
    }
    brought = dict(one.rsplit(" ", 1) for one in sorted(plugins) if one)
    found = {name: _version(name) for name in _LIBRARIES}
    return {
        "python": sys.version.split()[0],
        "platform": f"{platform.system()} {platform.machine()}",
        **{name: one for name, one in found.items() if one},
        **brought,
    }


def _plugin_files(graph: Graph) -> list[dict[str, str]]:
    """Return the plugin files that were named, with the SHA-256 of what was imported."""
    return [
        {"path": str(one.module.__file__), "sha256": one.digest}
        for one in graph.registry.loaded
        if one.digest
    ]


def _node(node: GraphNode) -> dict[str, Any]:
    return {
        "axes": list(node.axes),
        "gathered": list(node.gathered),
        "methods": {
            label or node.first.node.name: {
                "use": method.node.name,
                "plugin": method.plugin,
                "outputs": [port.name for port in method.node.outputs],
            }
            for label, method in node.methods.items()
        },
    }


def repeating(command: str, step: Step) -> str:
    """Return the command that repeats one step alone; what feeds it comes from the store."""
    only = (f" --only {shlex.quote(f'{axis}={label}')}" for axis, label in step.labels.items())
    return f"{command}{''.join(only)} --until {shlex.quote(step.node)}"


def _code(run: Run) -> dict[str, Any]:
    """Return what each method's code reaches, by plugin and name."""
    if run.recall is None:
        return {}
    reached = {
        f"{step.method.plugin}:{step.method.node.name}": run.recall.keys.fixed(step).reached
        for step in run.plan.steps
    }
    return {
        name: {"units": dict(one.units), "versions": dict(one.versions)}
        for name, one in reached.items()
    }


def _steps(run: Run, command: str) -> list[dict[str, Any]]:
    shared = _shared(run)
    return [
        _step(run, step, outcome, command) | shared.get(step.index, {})
        for step, outcome in run.settled()
    ]


def _shared(run: Run) -> dict[int, dict[str, Any]]:
    """Return the other combinations of steps that stand for several: equal work is done once."""
    others: dict[int, list[dict[str, Any]]] = {}
    for name, cells in run.plan.cells.items():
        axes = run.plan.graph.nodes[name].axes
        for combination, index in cells.items():
            labels = dict(zip(axes, combination, strict=True))
            step = run.plan.steps[index]
            if (step.node, step.labels) != (name, labels):
                others.setdefault(index, []).append({"node": name, "labels": plain(labels)})
    return {index: {"also": found} for index, found in others.items()}


def _step(run: Run, step: Step, outcome: Outcome, command: str) -> dict[str, Any]:
    made: dict[str, Any] = {
        "step": step.index,
        "node": step.node,
        "use": step.method.node.name,
        "labels": plain(step.labels),
        "settings": {name: plain(value) for name, value in step.shown.items()},
        "inputs": {port: _needs(run, fed) for port, fed in step.inputs.items()},
        "state": outcome.state,
        "seconds": round(outcome.seconds, 6),
    }
    said: dict[str, Any] = {
        "stored": outcome.stored,
        "reason": outcome.reason,
        "place": outcome.place,
        "trace": outcome.trace,
        "warnings": list(outcome.warnings),
        "digests": list(outcome.digests),
        "repeat": repeating(command, step) if outcome.state == "failed" else "",
    }
    if run.recall is not None:
        said["key"] = run.recall.keys.of[step.index]
        said["files"] = dict(run.recall.keys.fixed(step).files)
    return made | {key: one for key, one in said.items() if one}


def _needs(run: Run, fed: StepInput) -> Any:
    """Return which outputs of which steps feed a port, with their labels where it gathers."""
    if isinstance(fed, Output):
        return _output(run, fed)
    return [
        {"labels": plain(dict(zip(fed.axes, at, strict=True))), **_output(run, one)}
        for at, one in fed.entries
    ]


def _output(run: Run, output: Output) -> dict[str, Any]:
    ports = run.plan.steps[output.step].method.node.outputs
    return {"step": output.step, "output": ports[output.position].name}


def _skipped(run: Run) -> list[Mapping[str, Any]]:
    return [
        {"node": name, "labels": dict(zip(node.axes, at, strict=True)), "reason": reason}
        for name, node in run.plan.graph.nodes.items()
        for at, reason in run.plan.skipped[name].items()
    ]


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
