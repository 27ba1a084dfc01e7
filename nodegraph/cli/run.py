"""``nodegraph run``: run a graph and write its report."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from nodegraph.cli.arguments import add_executor, add_graph, add_store
from nodegraph.cli.output import say

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


def run(arguments: Namespace) -> int:
    """Run a graph, write its folder, and print its tables."""
    from nodegraph.cli.graphs import graph_of, how_of, run_folder, run_of
    from nodegraph.execute import executor_of
    from nodegraph.report.compose import summary
    from nodegraph.runs.folder import REPORT, RunFolder

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
        )
    except Exception:
        folder.abandon()
        raise
    except KeyboardInterrupt:
        if arguments.cache:
            say("finished steps are stored; the same command continues from there")
        raise
    if folder.moved:
        say(f"the earlier run is now in {folder.moved}")
    written = finished.write_to(folder)
    report = folder.path if REPORT in written.lost else folder.path / REPORT
    print(f"{summary(written.study, finished)}\n\n{report}")
    for name, reason in written.lost.items():
        say(f"{folder.path / name}: cannot be written: {reason}")
    return 0 if written.study.ok and not written.lost else 1
