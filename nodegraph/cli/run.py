"""``nodegraph run``: run a graph and write its report."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_executor, add_graph, add_json, add_store
from nodegraph.cli.output import console, say

HELP = "Run a graph and write its report."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_graph(parser)
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="Folder to write to (default: runs/GRAPH)."
    )
    add_executor(parser)
    parser.add_argument(
        "--until",
        action="append",
        default=[],
        metavar="NODE",
        help="Compute this node and what it needs, and no others.",
    )
    parser.add_argument(
        "--no-cache",
        action="store_false",
        dest="cache",
        help="Neither use stored results nor store new ones.",
    )
    add_store(parser)
    amount = parser.add_mutually_exclusive_group()
    amount.add_argument(
        "--full", action="store_true", help="Print whole tables, all warnings and all failures."
    )
    amount.add_argument(
        "-q", "--quiet", action="store_true", help="Print nothing but errors and failures."
    )
    add_json(amount)


def run(arguments: Namespace) -> int:
    """Run a graph, write its folder, and print what it gave."""
    from nodegraph.cli.graphs import graph_of, how_of, run_folder, run_of
    from nodegraph.cli.summary import print_summary, run_answer
    from nodegraph.execute.executor import executor_of
    from nodegraph.runs.folder import RunFolder

    graph = graph_of(arguments)
    # these raise errors, before an earlier run is moved aside
    executor_of(how_of(arguments), graph.registry)
    graph.until(arguments.until)
    folder = RunFolder(arguments.out or run_folder(arguments), graph.spec.text, graph.spec.included)
    try:
        finished = run_of(
            arguments,
            graph,
            cache=arguments.cache,
            until=arguments.until,
            listeners=[folder.hear],
            quiet=arguments.quiet,
        )
    except Exception:
        folder.abandon()
        raise
    except KeyboardInterrupt:
        if arguments.cache:
            say("finished steps are stored; the same command continues from there")
        raise
    written = finished.write_to(folder)
    if folder.replaced and not arguments.quiet:
        say(f"the earlier run in {folder.path} had the same results; it has been replaced")
    elif folder.moved and not arguments.quiet:
        say(f"the earlier run is now in {folder.moved}")
    if arguments.json:
        from nodegraph.cli.answers import print_json

        print_json(run_answer(written.study, finished, folder.path))
    elif not arguments.quiet:
        print_summary(
            written.study,
            finished,
            folder.path,
            console(sys.stdout),
            full=arguments.full,
            lost=written.lost,
        )
    for name, reason in written.lost.items():
        say(f"{folder.path / name}: cannot be written: {reason}")
    sys.stdout.flush()
    finished.tidy()
    return 0 if written.study.ok and not written.lost else 1
