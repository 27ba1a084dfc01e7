"""``nodegraph lock``: freeze a study."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_executor, add_graph, add_store
from nodegraph.cli.output import refuse_unwritable, say, write_and_print
from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of

HELP = "Freeze a study: write its results, and everything that decides them, as a lock."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="File to write (default: GRAPH.lock)."
    )
    add_executor(parser)
    add_store(parser)


def lock(arguments: Namespace) -> int:
    """Run a graph, and write its lock."""
    from nodegraph.cli.graphs import graph_of, run_of
    from nodegraph.lock.lockfile import SUFFIX, is_lock, lock_text
    from nodegraph.lock.portable import FileNames

    graph = graph_of(arguments)
    path = arguments.out or arguments.graph.with_suffix(SUFFIX)
    if path.exists() and not (path.is_file() and is_lock(path)):
        raise NodegraphError(f"{path} exists and is not a lock; name another file with --out")
    refuse_unwritable(path)
    FileNames(graph)  # raises for files that a lock must not name, before anything has run
    run = run_of(arguments, graph)
    not_stored = run.not_stored()  # before results that are not stored are computed again
    text = lock_text(run, path)
    counts = ", ".join(f"{count} {state}" for state, count in run.counts().items() if count)
    print(f"{number_of(len(run.plan.steps), 'step')}: {counts}")
    for line in not_stored:
        print(line)
    write_and_print(path, text.encode())
    if not run.ok:
        say("some steps failed; the lock records that")
    run.tidy()
    return 0 if run.ok else 1
