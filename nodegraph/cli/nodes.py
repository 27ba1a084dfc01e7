"""``nodegraph nodes``: list the installed nodes."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError, nearest

HELP = "List the installed nodes."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "word",
        nargs="?",
        metavar="WORD",
        help="Family, such as fill, or part of a name or summary.",
    )
    add_plugin(parser)


def nodes(arguments: Namespace) -> int:
    """List the installed nodes."""
    from nodegraph.node.description import summary_of
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed(arguments.plugin)
    word = (arguments.word or "").removesuffix(".*").lower()
    rows = [(entry.node.name, summary_of(entry.node), entry.plugin) for entry in registry]
    family = [row for row in rows if row[0].startswith(f"{word}.")]
    matches = family or [row for row in rows if word in f"{row[0]} {row[1]}".lower()]
    if word and not matches:
        names = [row[0] for row in rows] if "." in word else registry.families
        raise NodegraphError(f"no node has {word!r} in its name or summary; {nearest(word, names)}")
    print(columns(matches))
    return 0
