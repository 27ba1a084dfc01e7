"""A run as plain data, for ``run.json``: what ran, with which settings, how it ended."""

from __future__ import annotations

import platform
import sys
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from nodegraph.execute.call import Outcome
from nodegraph.execute.results import Run
from nodegraph.graph import Graph, GraphNode
from nodegraph.plan import Gathered, Step

FORMAT = 1
_LIBRARIES = ("nodegraph", "numpy", "scipy", "pandas", "numba", "scikit-learn", "matplotlib")


def record(run: Run) -> dict[str, Any]:
    """Return everything about a run but its values."""
    graph = run.plan.graph
    return {
        "format": FORMAT,
        "title": graph.title,
        "inputs": dict(graph.inputs),
        "axes": {name: list(axis.labels) for name, axis in graph.axes.items()},
        "nodes": {name: _node(node) for name, node in graph.nodes.items()},
        "known": [str(one) for one in graph.spec.known],
        "left_out": [{"node": one.node, "reason": one.reason} for one in graph.left_out],
        "counts": run.counts(),
        "seconds": round(run.seconds, 6),
        "steps": [_step(step, outcome) for step, outcome in run.settled()],
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


def _node(node: GraphNode) -> dict[str, Any]:
    return {
        "axes": list(node.axes),
        "gathered": list(node.gathered),
        "methods": {
            label or node.first.node.name: {"use": method.node.name, "plugin": method.plugin}
            for label, method in node.methods.items()
        },
    }


def _step(step: Step, outcome: Outcome) -> dict[str, Any]:
    made: dict[str, Any] = {
        "step": step.index,
        "node": step.node,
        "use": step.method.node.name,
        "labels": dict(step.labels),
        "settings": {name: _plain(value) for name, value in step.shown.items()},
        "inputs": {port: _needs(fed) for port, fed in step.inputs.items()},
        "state": outcome.state,
        "seconds": round(outcome.seconds, 6),
    }
    said = {"reason": outcome.reason, "trace": outcome.trace, "warnings": list(outcome.warnings)}
    return made | {key: one for key, one in said.items() if one}


def _needs(fed: Any) -> Any:
    return [one.step for _, one in fed.entries] if isinstance(fed, Gathered) else fed.step


def _skipped(run: Run) -> list[Mapping[str, Any]]:
    return [
        {"node": name, "labels": dict(zip(node.axes, at, strict=True)), "reason": reason}
        for name, node in run.plan.graph.nodes.items()
        for at, reason in run.plan.skipped[name].items()
    ]


def _plain(value: Any) -> Any:
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, dict):
        return {str(key): _plain(one) for key, one in value.items()}
    return value if value is None or isinstance(value, (str, int, float, bool)) else str(value)


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""
