"""``nodegraph nodes``: list the installed nodes."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import columns
from nodegraph.errors import NodegraphError, nearest

HELP = "List the installed nodes."


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("family", nargs="?", metavar="FAMILY", help="Family, such as fill.")
    add_plugin(parser)


def nodes(arguments: Namespace) -> int:
    """List the installed nodes."""
    from nodegraph.node.description import summary_of
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed(arguments.plugin)
    family = (arguments.family or "").removesuffix(".*")
    if "." in family:
        registry.find(family)
        raise NodegraphError(
            f"{family!r} is a node, not a family; `nodegraph show {family}` shows it"
        )
    if family and not registry.family(family):
        raise NodegraphError(f"no family {family!r}; {nearest(family, registry.families)}")
    print(
        columns(
            [
                (entry.node.name, summary_of(entry.node), entry.plugin)
                for entry in registry
                if not family or entry.node.family == family
            ]
        )
    )
    return 0
