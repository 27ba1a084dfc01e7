"""Load a graph, run it, take its values, save the run; commands do the same by these functions."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.errors import NodegraphError
from nodegraph.execute import results
from nodegraph.execute.events import Event, Listener
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.resume import open_store
from nodegraph.execute.run import execute
from nodegraph.execute.settings import settings_of
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_file
from nodegraph.node.ports import Label
from nodegraph.plan import plan
from nodegraph.plugin.kind import late
from nodegraph.plugin.registry import Registry, default_registry
from nodegraph.store import Store

if TYPE_CHECKING:
    from nodegraph.report.write import WrittenRun
    from nodegraph.runs.folder import RunFolder


@dataclass(frozen=True, repr=False)
class Run(results.Run):
    """A finished run that can be saved.

    Attributes
    ----------
    events : tuple of Event
        Everything that happened, in order.
    """

    events: tuple[Event, ...] = ()

    def save(self, folder: str | Path) -> None:
        """Write the run as ``nodegraph run`` does.

        Report, tables, figures, record, events and the graph are written, so that ``nodegraph
        report``, ``diff``, ``cite``, ``archive`` and ``export`` work on the folder.

        Parameters
        ----------
        folder
            A run that is already there is kept: its folder is renamed to end with the time at
            which it was written. Only one with the same graph, settings and results is replaced.

        Raises
        ------
        NodegraphError
            If the folder is not a run folder, or if a file cannot be written; all others are then
            written, and ``run.json`` lists those that are not.

        Examples
        --------
        >>> import nodegraph as ng
        >>> run = ng.run("graphs/fill.yaml", only={"fill": ["muscle"]})  # doctest: +SKIP
        >>> run.save("runs/fill")  # doctest: +SKIP
        """
        from nodegraph.runs.folder import RunFolder

        spec = self.plan.graph.spec
        run_folder = RunFolder(Path(folder), spec.text, spec.included)
        for event in self.events:
            run_folder.hear(event)
        lost = self.write_to(run_folder).lost
        if lost:
            raise NodegraphError(
                "\n".join(
                    f"{run_folder.path / name}: cannot be written: {reason}"
                    for name, reason in lost.items()
                )
            )

    def write_to(self, folder: RunFolder) -> WrittenRun:
        """Write record and report into a folder that has the graph and the events already."""
        from nodegraph.report.write import write_run

        try:
            written = write_run(self, folder)
            folder.replace_same()
            return written
        finally:
            folder.close()


def load(
    graph: str | Path,
    *,
    plugins: Iterable[str | Path] = (),
    set: Mapping[str, object] | None = None,
    axis: Mapping[str, object] | None = None,
    only: Mapping[str, Label | Iterable[Label]] | None = None,
) -> Graph:
    """Read and validate a graph file.

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
        If the graph is not valid; all errors are reported, each with its place.
    """
    registry = _registry(plugins) or default_registry()
    loaded = build(read_graph_file(Path(graph)), registry, _choices(set, axis, only))
    for notice in loaded.notices:
        warnings.warn(str(notice), stacklevel=2)
    return loaded


def run(
    graph: Graph | str | Path,
    *,
    plugins: Iterable[str | Path] = (),
    set: Mapping[str, object] | None = None,
    axis: Mapping[str, object] | None = None,
    only: Mapping[str, Label | Iterable[Label]] | None = None,
    until: Iterable[str] = (),
    executor: str = "",
    jobs: int | None = None,
    scheduler: str = "",
    timeout: float | None = None,
    memory: float | None = None,
    cache: bool = True,
    store: str | Path | None = None,
    listeners: Iterable[Listener] = (),
) -> Run:
    """Run a graph; stored results are used, and a failed step does not stop the others.

    Parameters
    ----------
    graph
        A loaded graph, or a path.
    plugins, set, axis, only
        As in `load`; they come on top of those of a loaded graph.
    until
        Nodes to compute, with what they need; all by default.
    executor
        ``threads``, ``serial``, ``processes``, or the name of a plugin's; by default ``threads``,
        and ``processes`` with `timeout` or `memory`.
    jobs
        Number of steps at a time; by default the number of processors.
    scheduler
        Address of a Dask cluster.
    timeout
        Seconds after which a step has failed. Only the executor ``processes`` ends it then; in
        threads it continues until the program ends, and the run waits for a step that holds
        Python's interpreter lock.
    memory
        Gigabytes that a step may take beside its inputs, with the executor ``processes`` on Linux.
    cache
        Whether to use stored results and to store new ones.
    store
        The folder of stored results; by default ``NODEGRAPH_STORE``, else the platform's cache
        folder.
    listeners
        Called with every `nodegraph.execute.Event`.

    Raises
    ------
    GraphError
        If the graph or a choice is not valid; nothing has run.
    """
    if not isinstance(graph, Graph):
        graph = load(graph, plugins=plugins, set=set, axis=axis, only=only)
    elif set or axis or only or plugins:
        choices = graph.choices.updated(_choices(set, axis, only))
        graph = build(graph.spec, _registry(plugins) or graph.registry, choices)
    opened = open_store(graph.registry, Path(store) if store else None, _warn) if cache else None
    how = HowToRun(executor, jobs, scheduler, timeout, memory)
    finished = run_graph(graph, how, store=opened, until=until, listeners=listeners)
    finished.tidy()
    return finished


def run_graph(
    graph: Graph,
    how: HowToRun,
    *,
    store: Store | None,
    until: Iterable[str],
    listeners: Iterable[Listener],
) -> Run:
    """Run a graph with an open store, or without one."""
    nodes = list(until)
    settings = settings_of(graph, how, nodes, store)
    graph = graph.until(nodes) if nodes else graph
    events: list[Event] = []
    finished = execute(
        plan(graph),
        how=how,
        store=store,
        keep=reported(graph),
        listeners=[events.append, *listeners],
        settings=settings,
    )
    taken = {each.name: getattr(finished, each.name) for each in fields(finished) if each.init}
    return Run(**taken, events=tuple(events))


def reported(graph: Graph) -> tuple[str, ...]:
    """Return the nodes that the report shows: as listed, else those that nothing reads."""
    return tuple(dict.fromkeys(node for node, _ in graph.reported))


def _warn(text: str) -> None:
    warnings.warn(text, stacklevel=2)


def _registry(plugins: Iterable[str | Path]) -> Registry | None:
    files = [Path(file) for file in plugins]
    return Registry.installed(files) if files else None


def _choices(
    inputs: Mapping[str, object] | None,
    axes: Mapping[str, object] | None,
    only: Mapping[str, Label | Iterable[Label]] | None,
) -> Choices:
    labels = {
        name: (label,) if isinstance(label, (str, int, float)) else tuple(label)
        for name, label in (only or {}).items()
    }
    return Choices(dict(inputs or {}), dict(axes or {}), labels)


def show_in_notebooks() -> None:
    """Register how IPython, where it runs, shows graphs and runs."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is not None:
        html = shell.display_formatter.formatters["text/html"]
        html.for_type(Graph, late("nodegraph.notebook:graph_html"))
        html.for_type(results.Run, late("nodegraph.notebook:run_html"))


show_in_notebooks()
