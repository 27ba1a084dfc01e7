"""The walk from Python: load a graph, run it, take its values."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from nodegraph.execute import HowToRun, Listener, Run, execute, open_store
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_file
from nodegraph.node.ports import Label
from nodegraph.plan import plan
from nodegraph.plugin.registry import Registry, default_registry


def load(
    graph: str | Path,
    *,
    plugins: Iterable[str | Path] = (),
    set: Mapping[str, Any] | None = None,
    axis: Mapping[str, Any] | None = None,
    only: Mapping[str, Label | Iterable[Label]] | None = None,
) -> Graph:
    """Read a graph file and check all of it.

    Parameters
    ----------
    graph
        A path.
    plugins
        Python files whose nodes the graph may use.
    set
        Values for inputs.
    axis
        Other labels for axes: a list, a mapping of labels to values, or a generator.
    only
        Labels to keep, of axes and of nodes with alternatives.

    Raises
    ------
    GraphError
        With every mistake at its place; nothing has run.
    """
    registry = _registry(plugins) or default_registry()
    built = build(read_graph_file(Path(graph)), registry, _choices(set, axis, only))
    for one in built.notices:
        warnings.warn(str(one), stacklevel=2)
    return built


def run(
    graph: Graph | str | Path,
    *,
    plugins: Iterable[str | Path] = (),
    set: Mapping[str, Any] | None = None,
    axis: Mapping[str, Any] | None = None,
    only: Mapping[str, Label | Iterable[Label]] | None = None,
    until: Iterable[str] = (),
    executor: str = "threads",
    jobs: int | None = None,
    scheduler: str = "",
    cache: bool = True,
    store: str | Path | None = None,
    listeners: Iterable[Listener] = (),
) -> Run:
    """Run a graph; what is stored is not computed again, and what fails does not stop the others.

    Parameters
    ----------
    graph
        A loaded graph, or a path.
    plugins, set, axis, only
        As in `load`; they come on top of what a loaded graph was given.
    until
        Nodes to compute, with what they need; all by default.
    executor
        ``threads``, ``serial``, ``processes``, ``dask``, or one that a plugin brings.
    jobs
        Steps at a time; as many as there are processors by default.
    scheduler
        Address of a Dask cluster.
    cache
        Whether to use stored results, and to store what is computed.
    store
        The folder of stored results; by default ``NODEGRAPH_STORE``, else the platform's.
    listeners
        Called with every `nodegraph.execute.Event`.

    Raises
    ------
    GraphError
        If the graph or a choice is wrong; nothing has run.
    """
    if not isinstance(graph, Graph):
        graph = load(graph, plugins=plugins, set=set, axis=axis, only=only)
    elif set or axis or only or plugins:
        choices = graph.choices.updated(_choices(set, axis, only))
        graph = build(graph.spec, _registry(plugins) or graph.registry, choices)
    graph = graph.until(until) if until else graph
    return execute(
        plan(graph),
        how=HowToRun(executor, jobs, scheduler),
        store=open_store(graph.registry, Path(store) if store else None, _warn) if cache else None,
        keep=reported(graph),
        listeners=listeners,
    )


def reported(graph: Graph) -> tuple[str, ...]:
    """Return the nodes that the report shows: as listed, else those that nothing reads."""
    return tuple(dict.fromkeys(node for node, _ in graph.reported))


def _warn(text: str) -> None:
    warnings.warn(text, stacklevel=2)


def _registry(plugins: Iterable[str | Path]) -> Registry | None:
    files = [Path(one) for one in plugins]
    return Registry.installed(files) if files else None


def _choices(
    given: Mapping[str, Any] | None,
    axis: Mapping[str, Any] | None,
    only: Mapping[str, Label | Iterable[Label]] | None,
) -> Choices:
    kept = {
        name: (one,) if isinstance(one, (str, int, float)) else tuple(one)
        for name, one in (only or {}).items()
    }
    return Choices(dict(given or {}), dict(axis or {}), kept)
