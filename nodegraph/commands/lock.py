"""``nodegraph lock``."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.commands.chosen import graph_of, say, store_of
from nodegraph.display import size_text
from nodegraph.errors import NodegraphError
from nodegraph.terminal import progress

if TYPE_CHECKING:
    from nodegraph.execute import Run
    from nodegraph.graph import Graph
    from nodegraph.store import Store


def lock(arguments: Namespace) -> int:
    """Run a graph, and write down what decides its results, and what they are."""
    from nodegraph.paper.frozen.lock import SUFFIX, lock_text
    from nodegraph.paper.frozen.names import FileNames

    graph = graph_of(arguments)
    path = arguments.out or arguments.graph.with_suffix(SUFFIX)
    _refuse_others(path)
    FileNames(graph)  # which refuses what a lock must not hold, before anything has run
    done = completed(arguments, graph, store_of(arguments, graph))
    text = lock_text(done, path)
    written(path, text)
    counts = ", ".join(f"{count} {state}" for state, count in done.counts().items() if count)
    print(f"{len(done.plan.steps)} steps: {counts}")
    print(f"{path} ({size_text(len(text.encode()))})")
    if not done.ok:
        say("some steps failed: the lock holds that they did")
    return 0 if done.ok else 1


def completed(arguments: Namespace, graph: Graph, store: Store) -> Run:
    """Run a graph as the command says, and show how far it is."""
    from nodegraph.api import reported
    from nodegraph.execute import HowToRun, execute
    from nodegraph.execute.left_out import left_out_lines
    from nodegraph.plan import plan

    how = HowToRun(arguments.executor, arguments.jobs, arguments.scheduler)
    for line in left_out_lines(graph):
        say(line)
    with progress() as shown:
        return execute(
            plan(graph), how=how, store=store, keep=reported(graph), listeners=[shown.hear]
        )


def written(path: Path, text: str) -> None:
    """Write a file whole or not at all."""
    unfinished = path.with_name(f"{path.name}.part")
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished.write_text(text, encoding="utf-8", newline="\n")
    unfinished.replace(path)


def _refuse_others(path: Path) -> None:
    from nodegraph.paper.frozen.lock import is_lock

    if path.is_dir() or (path.exists() and not is_lock(path)):
        raise NodegraphError(f"{path} is there and is no lock; name another file with --out")
