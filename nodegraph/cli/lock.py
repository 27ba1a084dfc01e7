"""``nodegraph lock``."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from nodegraph.cli.common import (
    completed,
    graph_of,
    refuse_unwritable,
    say,
    store_of,
    written_and_told,
)
from nodegraph.errors import NodegraphError


def lock(arguments: Namespace) -> int:
    """Run a graph, and write down what decides its results, and what they are."""
    from nodegraph.lock.lockfile import SUFFIX, lock_text
    from nodegraph.lock.provenance import FileNames

    graph = graph_of(arguments)
    path = arguments.out or arguments.graph.with_suffix(SUFFIX)
    _refuse_others(path)
    refuse_unwritable(path)
    FileNames(graph)  # which refuses what a lock must not hold, before anything has run
    done = completed(arguments, graph, store_of(arguments, graph))
    not_stored = done.not_stored()  # before what is not stored is computed again
    text = lock_text(done, path)
    counts = ", ".join(f"{count} {state}" for state, count in done.counts().items() if count)
    print(f"{len(done.plan.steps)} steps: {counts}")
    for line in not_stored:
        print(line)
    written_and_told(path, text.encode())
    if not done.ok:
        say("some steps failed: the lock holds that they did")
    return 0 if done.ok else 1


def _refuse_others(path: Path) -> None:
    from nodegraph.lock.lockfile import is_lock

    if path.is_dir() or (path.exists() and not is_lock(path)):
        raise NodegraphError(f"{path} is there and is no lock; name another file with --out")
