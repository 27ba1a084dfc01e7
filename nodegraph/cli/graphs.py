"""The graph that a command names, its store, and its run."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph import supervisor
from nodegraph.cli.arguments import pairs, values_of
from nodegraph.cli.output import say
from nodegraph.errors import GraphError, NodegraphError
from nodegraph.execute.events import Event, EventKind, Listener
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.resume import open_store
from nodegraph.filenames import portable_name
from nodegraph.graph import Choices, Graph, build
from nodegraph.graph.option_text import read_axis, read_labels
from nodegraph.graphfile import GraphSpec, read_graph_file
from nodegraph.plugin.registry import Registry
from nodegraph.store import Store

if TYPE_CHECKING:
    from nodegraph.api import Run


def graph_of(arguments: Namespace) -> Graph:
    """Return the graph that a command names, validated, with the choices of its options."""
    _refuse_lock(arguments.graph)
    registry = Registry.installed(arguments.plugin)
    axes = {
        name: read_axis(f"--axis {name}", text) for name, text in pairs(arguments, "axis").items()
    }
    only = {
        name: tuple(read_labels(f"--only {name}", text))
        for name, text in pairs(arguments, "only").items()
    }
    choices = Choices(values_of(arguments, "set"), axes, only)
    graph = build(_spec_of(arguments.graph, registry), registry, choices)
    for notice in graph.notices:
        say(str(notice))
    return graph


def _spec_of(path: Path, registry: Registry) -> GraphSpec:
    """Return the spec of a graph file; a recording in its place is told what it is good for."""
    try:
        return read_graph_file(path)
    except GraphError:
        formats = registry.hooks.formats
        kinds = [each.name for each in formats if path.suffix.lower() in each.suffixes]
        if path.is_file() and kinds:
            raise NodegraphError(
                f"{path}: no graph, but a file to read ({kinds[0]}): write nodegraph run GRAPH "
                f"--set recording={path}, or for several files --axis recording={path},OTHER"
            ) from None
        raise


def _refuse_lock(path: Path) -> None:
    if path.suffix in (".yaml", ".yml") or not path.is_file():
        return
    from nodegraph.lock.lockfile import is_lock

    if is_lock(path):
        raise NodegraphError(f"{path}: this is a lock; use `nodegraph verify {path}`")


def run_folder(arguments: Namespace) -> Path:
    """Return the default folder for runs of the graph."""
    return Path("runs") / portable_name(arguments.graph.stem)


def store_of(arguments: Namespace, graph: Graph, say: Callable[[str], None] = say) -> Store:
    """Return the store that a command uses; its problems are reported."""
    return open_store(graph.registry, arguments.store, say)


def left_out_lines(graph: Graph) -> list[str]:
    """Return which nodes are left out: ``left out: faces, playback: why``."""
    return [
        f"left out: {', '.join(nodes)}: {reason}"
        for reason, nodes in graph.left_out_together().items()
    ]


def how_of(arguments: Namespace) -> HowToRun:
    """Return where steps are computed."""
    return HowToRun(
        arguments.executor,
        arguments.jobs,
        arguments.scheduler,
        arguments.timeout,
        arguments.memory,
    )


def run_of(
    arguments: Namespace,
    graph: Graph,
    *,
    store: Store | None = None,
    cache: bool = True,
    until: Iterable[str] = (),
    listeners: Iterable[Listener] = (),
    quiet: bool = False,
) -> Run:
    """Run a graph with the options of a command, and show its progress.

    Parameters
    ----------
    arguments
    graph
    store
        By default that of the command, unless the run is without `cache`.
    cache
    until, listeners
        As in `nodegraph.api.run`.
    quiet
        As in `nodegraph.cli.progress.progress`.
    """
    from nodegraph.api import run_graph
    from nodegraph.cli.progress import progress

    how = how_of(arguments)
    if how.timeout is not None and how.executor != "processes":
        say(
            f"executor {how.executor!r} cannot end a step that takes too long: it continues "
            "beside the others, which wait for it if it holds Python's interpreter lock"
        )
    for line in () if quiet else left_out_lines(graph):
        say(line)
    with progress(quiet=quiet) as display, supervisor.in_run():
        if store is None and cache:
            store = store_of(arguments, graph, display.say)
        return run_graph(
            graph, how, store=store, until=until, listeners=[_Running(), display, *listeners]
        )


class _Running:
    """Says which nodes are running, should the program end with them."""

    def __init__(self) -> None:
        self._names: dict[int, str] = {}

    def __call__(self, event: Event) -> None:
        if event.kind == EventKind.STARTED:
            self._names[event.step] = event.detail["use"]
        elif self._names.pop(event.step, None) is None:
            return
        supervisor.running(dict.fromkeys(self._names.values()))
