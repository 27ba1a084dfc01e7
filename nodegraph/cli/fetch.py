"""``nodegraph fetch``: download the files that a graph names by their addresses."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from nodegraph.cli.arguments import add_graph, values_of
from nodegraph.cli.output import say
from nodegraph.errors import NodegraphError

HELP = "Download the files that a graph names by their addresses."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.description = (
        f"{HELP} Each is kept in the user's cache folder if its SHA-256 is that of the address. No "
        "other command downloads anything."
    )
    add_graph(parser, "Graph file, or a lock.")


def fetch(arguments: Namespace) -> int:
    """Fetch the files of a graph, as its options choose them."""
    from nodegraph.cli.graphs import graph_of
    from nodegraph.lock.lockfile import is_lock, read_lock
    from nodegraph.lock.restore import unlocked
    from nodegraph.plugin.registry import Registry
    from nodegraph.remote import fetching

    with fetching() as outcomes:
        try:
            if arguments.graph.is_file() and is_lock(arguments.graph):
                if arguments.axis or arguments.only:
                    raise NodegraphError("a lock has its labels: --axis and --only are for graphs")
                registry = Registry.installed(arguments.plugin)
                path = arguments.graph
                unlocked(read_lock(path), path, registry, values_of(arguments, "set"))
            else:
                graph_of(arguments)
        finally:
            for address, error in outcomes.items():
                print(f"{'not fetched' if error else 'here'}: {address}")
    if not outcomes:
        say("the graph names no file by its address")
    return 0
